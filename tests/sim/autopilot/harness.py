"""An autopilot with a body in a world, and a stub of the vehicle around them.

    flight = AutopilotHarness(VehicleType.COPTER)
    flight.arm()
    flight.fly(Takeoff)
    flight.run_until(lambda: flight.height > 9, timeout=30)

It has no services, telemetry, parameters and logs, so that parts of the autopilot are tested alone, in
virtual time. Tests set flight parameters as attributes: `flight.flight_parameters.return_altitude = 30`.
"""

from __future__ import annotations

import types
from collections import defaultdict
from dataclasses import dataclass, field
from math import hypot, inf, pi
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.mission import PlanStore
from mavstack.services.modes import AvailableMode
from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
from mavstack.sim.autopilot.firmware_profile import FirmwareProfile, Mode
from mavstack.sim.autopilot.flight_parameters import FlightParameters
from mavstack.sim.autopilot.radio import Sticks
from mavstack.sim.autopilot.ticks import TICK
from mavstack.sim.motion import World
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from tests.waiting import step_until

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services import Event
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot as Autopilot
    from mavstack.sim.autopilot.behaviour import Behaviour

START = 1_700_000_000.0
RATE = 50.0
#: `custom_mode` of the stub's modes.
HOLD, GUIDED, MISSION, RETURN, LAND, TAKEOFF, OTHER = range(7)
_F = common.MavFrame

FLIGHT_PARAMETERS: dict[str, Any] = {
    "takeoff_altitude": 10.0,
    "cruise_speed": 8.0,
    "climb_speed": 2.5,
    "sink_speed": 1.5,
    "land_speed": 0.5,
    "acceptance_radius": 2.0,
    "loiter_radius": 60.0,
    "return_altitude": 20.0,
    "return_loiter_time": 2.0,
    "setpoint_timeout": 3.0,
    "disarm_delay": 10.0,
    "lean_angle": 0.5,
    "pilot_climb_speed": 2.5,
    "pilot_yaw_rate": 1.5,
    "acro_rate": 3.0,
    "land_slow_altitude": 8.0,
    "land_disarm_delay": 0.5,
    "return_descend_altitude": inf,
    "return_cone_slope": 0.0,
    "glide_slope": 0.09,
    "flare_altitude": 3.0,
    "circle_radius": 10.0,
    "circle_speed": 4.0,
    "circles_where_it_is": False,
    "setpoint_frames": frozenset({_F.LOCAL_NED, _F.LOCAL_OFFSET_NED, _F.BODY_NED, _F.BODY_OFFSET_NED}),
    "thrust_is_climb": False,
    "forward_beyond": inf,
}
OF_TYPE: dict[VehicleType, dict[str, Any]] = {
    VehicleType.PLANE: {"cruise_speed": 18.0, "acceptance_radius": 30.0, "return_altitude": 60.0},
    VehicleType.VTOL: {"return_altitude": 60.0, "loiter_radius": 80.0},
    VehicleType.ROVER: {"cruise_speed": 3.0},
    VehicleType.BOAT: {"cruise_speed": 2.0},
    VehicleType.SUB: {"cruise_speed": 1.0, "climb_speed": 0.5, "sink_speed": 0.5, "return_altitude": -3.0},
}


FLIGHT_PARAMETER_NAMES = sorted(FlightParameters.__annotations__.keys() - {"limits"})


def new_flight_parameters(kind: VehicleType = VehicleType.COPTER, **values: Any) -> Any:
    """FlightParameters of which every one can be set."""
    given = FLIGHT_PARAMETERS | OF_TYPE.get(kind, {}) | values
    names = {name: given.get(name, 1.0) for name in FLIGHT_PARAMETER_NAMES}
    if kind is VehicleType.VTOL:
        names["cruise_speed"] = property(lambda self: 20.0 if self.body.flies_forward else 8.0)
    return type("StubFlightParameters", (FlightParameters,), names)(None)


class StubProfile(FirmwareProfile):
    """Modes by what they mean; arms always, and says nothing."""

    initial = hold = HOLD
    guided, mission, return_to_launch, land = GUIDED, MISSION, RETURN, LAND

    def __init__(
        self, flight_parameters: Any, behaviours: dict[int, Callable[[Autopilot], Behaviour]]
    ) -> None:
        self._flight_parameters = flight_parameters
        self.problems: list[str] = []
        self.modes = [Mode(AvailableMode(n, f"MODE{n}"), make) for n, make in sorted(behaviours.items())]

    def flight_parameters(self, vehicle: Any) -> Any:
        return self._flight_parameters

    def arming_problems(self, autopilot: Autopilot) -> Iterator[str]:
        yield from self.problems

    def register(self, vehicle: Any) -> None: ...

    def provide(self, vehicle: Any) -> None: ...


@dataclass(eq=False)
class StubRadio:
    """Sticks that a test moves."""

    sticks: Sticks = field(default_factory=lambda: Sticks(0.0, 0.0, 0.5, 0.0))
    present: bool = True


@dataclass(eq=False)
class StubVehicle:
    """As much of a vehicle as an autopilot touches."""

    body: Any
    vehicle_type: VehicleType
    profile: StubProfile
    now: float = START
    firmware: Firmware = Firmware.ARDUPILOT
    terrain: Any = None
    address: Address = field(default_factory=lambda: Address(1, 1))
    plans: PlanStore = field(default_factory=PlanStore)
    status_texts: list[str] = field(default_factory=list)
    reactions: dict[Any, list[Any]] = field(default_factory=lambda: defaultdict(list))
    modes: Any = field(
        default_factory=lambda: types.SimpleNamespace(enter=lambda number, now, commanded=False: None)
    )
    mission: Any = field(default_factory=lambda: types.SimpleNamespace(home=None))
    faults: Any = field(default_factory=lambda: types.SimpleNamespace(active={}))
    parameters: dict[str, Any] = field(default_factory=dict)
    entered: list[tuple[int, str]] = field(default_factory=list)

    def on_event(self, kind: Any, reaction: Any) -> None:
        self.reactions[kind].append(reaction)

    def handle_event(self, event: Event) -> None:
        """Deliver an event of a service to the handlers of its type."""
        for reaction in self.reactions[type(event)]:
            reaction(event)

    def send_statustext(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        self.status_texts.append(text)

    def touch(self, service: Any) -> None: ...

    def mode_entered(self, mode: Mode, reason: str) -> None:
        self.entered.append((mode.number, reason))

    def armed_changed(self) -> None: ...

    def home_changed(self) -> None: ...


class AutopilotHarness:
    """A vehicle of a type, ready to arm, and its time."""

    def __init__(
        self,
        kind: VehicleType = VehicleType.COPTER,
        *,
        seed: int = 1,
        home: Home = DEFAULT_HOME,
        modes: dict[int, Callable[[Autopilot], Behaviour]] | None = None,
        **flight_parameters: Any,
    ) -> None:
        self.world = World(seed=seed, rate=RATE)
        self.body = self.world.add(kind, home)
        self.flight_parameters = new_flight_parameters(kind, **flight_parameters)
        self.flight_parameters.body = self.body
        self._other: Callable[[Autopilot], Behaviour] | None = None
        behaviours = default_behaviours() | {OTHER: self._make_other} | (modes or {})
        self.profile = StubProfile(self.flight_parameters, behaviours)
        self.vehicle: Any = StubVehicle(self.body, kind, self.profile)
        self.autopilot = SimulatedAutopilot(self.vehicle, self.profile)
        self.vehicle.autopilot = self.autopilot
        self.autopilot.radio = self.radio = StubRadio()
        self._steps = 0
        self.track: list[tuple[float, float, float]] = []
        self.run(3.0)

    # Time

    @property
    def now(self) -> float:
        return START + self._steps / RATE

    def step(self) -> None:
        self.world.step()
        self._steps += 1
        self.vehicle.now = self.now
        if self._steps % round(TICK * RATE) == 0:
            self.autopilot.tick(self.now)
            self.track.append(self.body.truth[:3])

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * RATE)):
            self.step()

    def run_until(self, holds: Callable[[], bool], *, timeout: float) -> float:
        """Step until a condition is true; return the seconds that passed, or fail after `timeout`."""
        return step_until(holds, self.step, lambda: self.now, timeout=timeout, description=lambda: self)

    # The vehicle

    @property
    def height(self) -> float:
        """Truly above the ground or the water."""
        return -self.body.truth.down

    def distance(self, point: tuple[float, ...] = (0.0, 0.0)) -> float:
        """Truly over the ground."""
        return hypot(self.body.truth.north - point[0], self.body.truth.east - point[1])

    @property
    def speed(self) -> float:
        return hypot(self.body.truth.velocity_north, self.body.truth.velocity_east)

    def arm(self) -> None:
        assert not self.autopilot.arm()

    def fly(self, behaviour: Callable[[Autopilot], Behaviour]) -> None:
        """Enter a mode with this behaviour."""
        self._other = behaviour
        self.autopilot.enter(OTHER, "test")

    def _make_other(self, autopilot: Autopilot) -> Behaviour:
        assert self._other is not None
        return self._other(autopilot)

    def enter(self, number: int) -> None:
        assert self.autopilot.enter(number, "test")

    def in_the_air(self, height: float = 20.0) -> AutopilotHarness:
        """Arm, and take off with whatever the type has for that."""
        self.arm()
        self.enter(TAKEOFF)
        self.autopilot.behaviour.altitude = height
        self.run_until(lambda: self.height > height - 2, timeout=90.0)
        self.run(5.0)
        return self

    def __str__(self) -> str:
        at = ", ".join(f"{value:.1f}" for value in self.body.truth[:6])
        autopilot = self.autopilot
        return f"{self.vehicle.vehicle_type} in {autopilot.mode.name}, armed {autopilot.armed}, at {at}"


def default_behaviours() -> dict[int, Callable[[Autopilot], Behaviour]]:
    """Return the default behaviours of the modes."""
    from mavstack.sim.autopilot.behaviours import Guided, Hold, Land, ReturnToLaunch, Takeoff

    return {HOLD: Hold, GUIDED: Guided, MISSION: Hold, RETURN: ReturnToLaunch, LAND: Land, TAKEOFF: Takeoff}


def turned(angle: float) -> float:
    """An angle from -pi to pi."""
    return (angle + pi) % (2 * pi) - pi
