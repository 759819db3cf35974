"""A ground station beside one simulated PX4, in virtual time.

    pilot = Pilot("copter")
    pilot.command(CMD.NAV_TAKEOFF, nan, ...)
    pilot.run_until(lambda: pilot.height > 9)

It speaks MAVLink in bytes, as any client would, and keeps what it heard.
"""

from __future__ import annotations

from functools import partial
from math import nan
from typing import TYPE_CHECKING, Any

from mavstack import Dialect, Parser, encode
from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.command import Command
from mavstack.services.modes.names import px4_modes_of
from mavstack.sim.simulation import Simulation
from mavstack.sim.telemetry import LinkMode, set_link_mode
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.waiting import step_until

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.dialects import Message
    from mavstack.services.mission import MissionItem

CMD, RESULT = common.MavCmd, common.MavResult
GROUND = Address(255, common.MavComponent.MISSIONPLANNER)
#: Where the vehicles stand, above the sea.
FIELD_ALTITUDE = 488.0


class Pilot:
    """One vehicle, and who speaks with it."""

    def __init__(self, kind: str = "copter", *, seed: int = 1, ready: bool = True) -> None:
        self.simulation = Simulation(seed=seed)
        self.vehicle = self.simulation.add(VehicleType(kind), Firmware.PX4)
        set_link_mode(self.vehicle, LinkMode.MINIMAL)  # what is not looked at is not made
        self.port = self.vehicle.open_port("ground")
        self._parser = Parser(Dialect.load("all"))
        self._sequence = 0
        self._heartbeat_due = 0.0
        self.heard: list[Message] = []
        self.texts: list[str] = []
        self.modes: list[str] = []
        self.vehicle.listeners.append(self._told)
        if ready:
            self.run(4.0)

    def _told(self, vehicle: Any, kind: str, text: str) -> None:
        if kind == "text":
            self.texts.append(text)
        elif kind == "mode":
            self.modes.append(text.removeprefix("mode "))

    # Time

    def run(self, seconds: float, each: Callable[[], object] | None = None) -> None:
        """Let time pass; `each` is called ten times a second."""
        for step in range(round(seconds * 50)):
            self.simulation.step()
            if self.simulation.now >= self._heartbeat_due:
                self._heartbeat_due = self.simulation.now + 1.0
                self.send(common.Heartbeat(type=common.MavType.GCS, autopilot=8, mavlink_version=3))
            if each is not None and step % 5 == 0:
                each()
        self._hear()

    def run_until(
        self, holds: Callable[[], bool], *, timeout: float = 60.0, each: Callable[[], object] | None = None
    ) -> None:
        """Step until a condition is true; fail after `timeout` seconds."""
        step = partial(self.run, 0.2, each)
        step_until(holds, step, lambda: self.simulation.now, timeout=timeout, description=lambda: self)

    # Talking

    def send(self, message: Message, source: Address = GROUND) -> None:
        data = encode(
            message, system=source.system, component=source.component, sequence=self._sequence & 255
        )
        self._sequence += 1
        self.vehicle.receive(self.port, data)
        self._hear()

    def command(
        self, command: int, *params: float, frame: int | None = None, source: Address = GROUND
    ) -> common.MavResult | None:
        """Send a command; gives its first answer."""
        before = len(self.heard)
        sent = Command.of(command, params, frame)
        target = self.vehicle.address
        self.send(sent.to_long(target) if frame is None else sent.to_int(target), source)
        for message in self.heard[before:]:
            if isinstance(message, common.CommandAck) and message.command == command:
                return RESULT(message.result)
        return None

    def result_of(self, command: int) -> common.MavResult | None:
        """The newest answer to a command."""
        acks = [ack for ack in self.all_of(common.CommandAck) if ack.command == command]
        return RESULT(acks[-1].result) if acks else None

    def set_mode(self, main: int, sub: int = 0, *, source: Address = GROUND) -> common.MavResult | None:
        return self.command(CMD.DO_SET_MODE, 1, main, sub, source=source)

    def arm(self) -> None:
        assert self.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.ACCEPTED, self.texts

    def request(self, kind: type[Message], *params: float) -> list[Any]:
        """Ask for a message once."""
        before = len(self.heard)
        self.command(CMD.REQUEST_MESSAGE, kind.__mavlink_row__[0], *params)
        self.run(0.5)
        return [message for message in self.heard[before:] if isinstance(message, kind)]

    def all_of(self, kind: type[Message]) -> list[Any]:
        return [message for message in self.heard if isinstance(message, kind)]

    def upload(self, items: Sequence[MissionItem]) -> int:
        """Send a mission as a client does; gives the MAV_MISSION_RESULT."""
        target = self.vehicle.address
        before = len(self.heard)
        self.send(
            common.MissionCount(
                target_system=target.system, target_component=target.component, count=len(items)
            )
        )
        for _ in range(200):
            new, before = self.heard[before:], len(self.heard)
            for message in new:
                if isinstance(message, common.MissionAck):
                    return int(message.type)
                if isinstance(message, common.MissionRequestInt | common.MissionRequest):
                    self.send(items[message.seq].to_int(target, message.seq, 0))
            self.run(0.1)
        raise AssertionError("the upload did not end")

    def _hear(self) -> None:
        for _, _, data in self.simulation.data_to_send():
            self.heard.extend(packet.message for packet in self._parser.feed(data))
        del self.heard[:-20_000]

    # The vehicle

    @property
    def autopilot(self) -> Any:
        return self.vehicle.autopilot

    @property
    def mode(self) -> str:
        return str(self.autopilot.mode.name)

    @property
    def heartbeat(self) -> tuple[int, tuple[int, int], int]:
        """Flags without the armed bit, main and sub mode, and state of the newest HEARTBEAT."""
        newest = self.all_of(common.Heartbeat)[-1]
        return int(newest.base_mode) & ~128, px4_modes_of(newest.custom_mode), int(newest.system_status)

    @property
    def height(self) -> float:
        return -self.vehicle.body.truth.down

    def in_the_air(self, height: float = 15.0) -> Pilot:
        """Take off, and hold."""
        altitude = FIELD_ALTITUDE + height
        assert self.command(CMD.NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, altitude) == RESULT.ACCEPTED
        self.arm()
        self.run_until(lambda: self.mode == "Hold", timeout=90.0)
        return self

    def __str__(self) -> str:
        at = ", ".join(f"{value:.1f}" for value in self.vehicle.body.truth[:6])
        return f"{self.vehicle.type} in {self.mode}, armed {self.autopilot.armed}, at {at}; {self.texts[-3:]}"
