"""The ground station of whole flights, with the records of the station and of the simulation.

The station knows the vehicles by MAVLink alone. A `Journal` holds the messages of each vehicle; `Sample`
holds the true state, which is not visible over MAVLink.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.services.statustext import StatusText
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.dialects import Message
    from mavstack.node import Node
    from mavstack.services.log import LogEntry
    from mavstack.sim.motion.readings import BatteryState, Motion
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle_types import VehicleType
    from tests.sim.whole_flights.plans import FlightPlan

CMD = common.MavCmd
#: Samples of the true state per second.
SAMPLES = 5
DEFAULT_TIMEOUT = 600.0
_ARMED = common.MavModeFlag.SAFETY_ARMED
_PREARM = common.MavSysStatusSensor.PREARM_CHECK
_MESSAGE_TYPES = (
    common.Heartbeat,
    common.SysStatus,
    common.MissionCurrent,
    common.MissionItemReached,
    common.ExtendedSysState,
    common.GlobalPositionInt,
)


class Sample(NamedTuple):
    """The true state at one moment, in simulated seconds from the start."""

    time: float
    motion: Motion
    battery: BatteryState
    airspeed: float
    throttle: float
    on_ground: bool
    transition: float
    armed: bool


@dataclass
class Journal:
    """The messages of one vehicle, with their times."""

    reached: list[tuple[float, int]] = field(default_factory=list)
    current: list[tuple[float, int]] = field(default_factory=list)
    states: list[int] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    modes: list[int] = field(default_factory=list)
    armed: bool = False
    ready: bool = False
    landed_state: int = 0
    latest: dict[type, Message] = field(default_factory=dict)

    def update(self, message: Message, now: float) -> None:
        self.latest[type(message)] = message
        match message:
            case common.Heartbeat(base_mode=flags, custom_mode=mode):
                self.armed = bool(flags & _ARMED)
                _append_change(self.modes, mode)
            case common.SysStatus():
                self.ready = bool(message.onboard_control_sensors_health & _PREARM)
            case common.MissionCurrent(seq=seq):
                if not self.current or self.current[-1][1] != seq:
                    self.current.append((now, seq))
                _append_change(self.states, int(message.mission_state))
            case common.MissionItemReached(seq=seq):  # PX4 repeats it
                if not self.reached or self.reached[-1][1] != seq:
                    self.reached.append((now, seq))
            case common.ExtendedSysState():
                self.landed_state = int(message.landed_state)


def _append_change(seen: list[int], value: int) -> None:
    if not seen or seen[-1] != value:
        seen.append(value)


@dataclass
class Flight:
    """One vehicle's flight, from power-on to the last message."""

    plan: FlightPlan
    track: list[Sample] = field(default_factory=list)
    journal: Journal = field(default_factory=Journal)
    downloaded: Sequence[object] = ()
    logs: tuple[LogEntry, ...] = ()
    log: bytes = b""
    began: float = 0.0
    ended: float = 0.0

    @property
    def kind(self) -> VehicleType:
        return self.plan.kind

    @property
    def flown(self) -> list[Sample]:
        """The samples while the vehicle was armed."""
        return [sample for sample in self.track if sample.armed]


class Station:
    """A simulation and the node that observes it."""

    def __init__(self, simulation: Simulation, node: Node) -> None:
        self.simulation, self.node = simulation, node
        self.journals: dict[int, Journal] = {}

    @property
    def now(self) -> float:
        return self.simulation.elapsed

    def journal(self, system: int) -> Journal:
        return self.journals.setdefault(system, Journal())

    async def listen(self) -> None:
        async with self.node.packets(*_MESSAGE_TYPES) as packets:
            async for packet in packets:
                if packet.component == common.MavComponent.AUTOPILOT1:
                    self.journal(packet.system).update(packet.message, self.now)

    async def listen_to_texts(self) -> None:
        async with self.node.events(StatusText) as texts:
            async for text in texts:
                self.journal(text.source.system).texts.append(text.text)

    async def wait_until(
        self, condition: Callable[[], bool], description: str, timeout: float = DEFAULT_TIMEOUT
    ) -> None:
        await wait_until(condition, description, timeout=timeout, interval=0.1, now=lambda: self.now)
