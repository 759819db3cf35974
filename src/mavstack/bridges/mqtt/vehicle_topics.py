"""The topics of one vehicle on MQTT, below `<prefix>/<vehicle>/`; `TOPICS` describes them."""

from __future__ import annotations

import asyncio
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.plain_json import json_bytes
from mavstack.bridges.mqtt.broker import Broker, Session
from mavstack.bridges.mqtt.commands import Commands
from mavstack.bridges.mqtt.groups import GROUPS, state, telemetry
from mavstack.bridges.mqtt.home_assistant import description, discovery_topic
from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from mavstack.node.dispatch import Listener
    from mavstack.vehicle import Vehicle

#: The values of the state whose changes are events.
_EVENTS: Final = ("armed", "mode", "in_air", "ready")


@dataclass(frozen=True, slots=True)
class TopicDescription:
    """A line of the table of topics.

    Attributes:
        topic: The topic, below that of the vehicle.
        payload: Its content in words.
        when: When it is published, or by whom.
    """

    topic: str
    payload: str
    when: str


#: All topics of a vehicle.
TOPICS: Final = (
    TopicDescription(
        "status",
        "`online` or `offline`",
        "retained; also the last will: the broker publishes `offline` when the bridge is gone",
    ),
    TopicDescription(
        "state",
        "mode, armed, readiness with problems, firmware, home, mission, the role of the bridge",
        "retained, when it changes",
    ),
    *(
        TopicDescription(f"telemetry/{name}", group.content, "`--rate` times a second")
        for name, group in GROUPS.items()
    ),
    TopicDescription("event/text", "status texts of the vehicle, with their severity", "when they come"),
    *(TopicDescription(f"event/{name}", "`value` and `previous`", "when it changes") for name in _EVENTS),
    TopicDescription("event/connection", "`connected`", "when the vehicle is lost or returns"),
    TopicDescription("cmd/<command>", "the arguments of a command", "by clients, not retained"),
    TopicDescription(
        "result/<command>", "`ok`, and the result or the reason", "for requests without a response topic"
    ),
)


@dataclass(frozen=True, slots=True)
class MqttOptions:
    """The options of the bridge.

    Attributes:
        broker: The broker.
        prefix: The beginning of all topics.
        rate: Hertz of telemetry, 1 to 5.
        role: The role of the bus.
        discovery: The prefix of Home Assistant's discovery; empty: none.
    """

    broker: Broker
    prefix: str = "mavstack"
    rate: float = 2.0
    role: Role = Role.OBSERVE
    discovery: str = ""


class VehicleTopics:
    """One vehicle on MQTT.

    Args:
        vehicle: The vehicle.
        name: Its name in topics.
        options: The options of the bridge.
    """

    def __init__(self, vehicle: Vehicle, name: str, options: MqttOptions) -> None:
        self.name = name
        self._vehicle = vehicle
        self._options = options
        self._base = f"{options.prefix}/{name}"
        reserved = tuple(f"{each}/" for each in (options.prefix, options.discovery) if each)
        self.commands = Commands(vehicle, self._base, options.role, self._answer, reserved=reserved)
        self.session = Session(
            options.broker,
            f"{self._base}/status",
            [self.commands.topic],
            connected=self._greet,
            take=self.commands.receive,
        )
        self._state: dict[str, Any] = {}
        self._described: dict[str, Any] = {}
        self._listeners: list[Listener] = []
        self._tasks: list[asyncio.Task[None]] = []

    async def open(self) -> None:
        """Connect, and publish from now on.

        Raises:
            LinkError: The broker does not answer, or refuses.
        """
        await self.session.open()
        listen = self._vehicle.connection.add_packet_listener
        self._listeners.append(
            listen(common.Heartbeat, lambda packet: self.update_state(), system=self._vehicle.system)
        )
        loop = asyncio.get_running_loop()
        self._tasks.append(loop.create_task(self._publish_telemetry()))
        if self._options.discovery:
            self._tasks.append(loop.create_task(self._describe()))

    async def close(self) -> None:
        """Publish that the vehicle is offline, and disconnect. Idempotent."""
        for listener in self._listeners:
            listener.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await self.commands.close()
        await self.session.close()

    def set_connected(self, *, connected: bool) -> None:
        """Publish that the vehicle was lost or returned."""
        self._publish_status(online=connected)
        self._event("connection", connected=connected)
        self.update_state()

    def receive_status_text(self, severity: int, text: str) -> None:
        """Publish a status text of the vehicle."""
        self._event("text", severity=int(severity), text=text)

    def update_state(self) -> None:
        """Publish the state if it has changed, and the events of the change."""
        found = {**state(self._vehicle), "role": self._options.role.word}
        before, self._state = self._state, found
        if found == before:
            return
        self._publish("state", found, qos=1, retain=True)
        for key in _EVENTS:
            if before and before[key] != found[key]:
                self._event(key, value=found[key], previous=before[key])

    # Publishing

    def _greet(self) -> None:
        """Publish the retained topics, after each connection."""
        self._publish_status(online=self._vehicle.alive)
        self._state = {}
        self.update_state()
        if self._described:
            self._publish_description()

    def _publish_status(self, *, online: bool) -> None:
        text = b"online" if online else b"offline"
        self.session.publish(f"{self._base}/status", text, qos=1, retain=True)

    async def _publish_telemetry(self) -> None:
        while True:
            for group in GROUPS:
                if self._vehicle.alive and (found := telemetry(self._vehicle, group)) is not None:
                    self._publish(f"telemetry/{group}", {"time": _now(), **found})
            await asyncio.sleep(1.0 / self._options.rate)

    def _event(self, kind: str, **fields: object) -> None:
        self._publish(f"event/{kind}", {"time": _now(), **fields}, qos=1)

    def _publish(self, topic: str, fields: dict[str, Any], *, qos: int = 0, retain: bool = False) -> None:
        self.session.publish(f"{self._base}/{topic}", json_bytes(fields), qos=qos, retain=retain)

    def _answer(self, topic: str, payload: bytes, correlation: bytes) -> None:
        self.session.publish(topic, payload, qos=1, correlation=correlation)

    # Home Assistant

    async def _describe(self) -> None:
        control = self._options.role >= Role.OPERATE
        self._described = self._description(control=control)
        self._publish_description()
        if not control:
            return
        try:
            modes = [mode.name for mode in await self._vehicle.modes.list()]
        except MavstackError:
            return  # without a list of modes, Home Assistant shows buttons but no mode selection
        self._described = self._description(modes, control=True)
        self._publish_description()

    def _description(self, modes: list[str] | None = None, *, control: bool) -> dict[str, Any]:
        found = state(self._vehicle)
        model = f"{found['autopilot']} {found['type']}"
        return description(
            self._base, self._identity, self.name, model=model, modes=modes or (), control=control
        )

    @property
    def _identity(self) -> str:
        return self._base.replace("/", "_")

    def _publish_description(self) -> None:
        topic = discovery_topic(self._options.discovery, self._identity)
        self.session.publish(topic, json_bytes(self._described), qos=1, retain=True)


def _now() -> float:
    return round(time.time(), 3)
