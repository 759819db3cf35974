"""The equipment of a vehicle: motors on the bench, servos, relays, gripper, winch, beeper, pointing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final, TypeAlias

from msgspec import Meta
from msgspec.structs import asdict

from mavstack.security.roles import Role
from mavstack.server.api.action_route import Action, action_route
from mavstack.server.request_types import Latitude, Longitude
from mavstack.vehicle.actuators import DEFAULT_TUNE, MAX_TUNE

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle

MAX_NUMBER: Final = 255
Number: TypeAlias = Annotated[int, Meta(ge=1, le=MAX_NUMBER, examples=[1])]


class RunMotor(Action):
    """Run one motor of a disarmed vehicle, without propellers."""

    motor: Annotated[Number, Meta(description="The number of the motor, from 1.")]
    throttle: Annotated[float, Meta(description="Percent.", ge=0, le=100)] = 5.0
    duration: Annotated[float, Meta(description="Seconds.", ge=0, le=600)] = 2.0

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        options = asdict(self)
        await vehicle.actuators.test_motor(options.pop("motor"), **options, wait=wait)


class SetServo(Action):
    """Set the pulse of a servo output (ArduPilot)."""

    servo: Annotated[Number, Meta(description="The number of the output, from 1.")]
    pulse: Annotated[int, Meta(description="Microseconds.", examples=[1500])]

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.actuators.set_servo(self.servo, self.pulse, timeout=self.timeout)


class SetRelay(Action):
    """Switch a relay (ArduPilot)."""

    relay: Annotated[
        int, Meta(description="The number of the relay, from 0.", ge=0, le=MAX_NUMBER, examples=[1])
    ]
    on: Annotated[bool, Meta(description="True switches it on.", examples=[True])]

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.actuators.set_relay(self.relay, self.on, timeout=self.timeout)


class SetActuator(Action):
    """Set an actuator output (PX4)."""

    actuator: Annotated[Number, Meta(description="The number of the actuator, from 1.")]
    value: Annotated[float, Meta(description="From -1 to 1.", ge=-1, le=1, examples=[0.5])]

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.actuators.set_actuator(self.actuator, self.value, timeout=self.timeout)


class MoveGripper(Action):
    """Open or close a gripper."""

    open: Annotated[bool, Meta(description="True opens it.", examples=[True])]
    gripper: Annotated[int, Meta(description="The number of the gripper, from 1.", ge=1, le=MAX_NUMBER)] = 1

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        move = vehicle.actuators.release if self.open else vehicle.actuators.grip
        await move(self.gripper, timeout=self.timeout)


class UnwindWinch(Action):
    """Pay out line from a winch, or wind it in."""

    length: Annotated[float, Meta(description="Metres; negative: wind in.", examples=[2.0])]
    rate: Annotated[float, Meta(description="Metres per second; 0: the default of the vehicle.")] = 0.0
    winch: Annotated[int, Meta(description="The number of the winch, from 1.", ge=1, le=MAX_NUMBER)] = 1

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        options = asdict(self)
        await vehicle.actuators.unwind(options.pop("length"), **options, wait=wait)


class RunWinch(Action):
    """Run a winch at a rate; 0 stops it."""

    rate: Annotated[float, Meta(description="Metres per second; negative: wind in.", examples=[0.0])]
    winch: Annotated[int, Meta(description="The number of the winch, from 1.", ge=1, le=MAX_NUMBER)] = 1

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.actuators.run_winch(self.rate, winch=self.winch, wait=wait, timeout=self.timeout)


class RelaxWinch(Action):
    """Let the line of a winch run free."""

    winch: Annotated[int, Meta(description="The number of the winch, from 1.", ge=1, le=MAX_NUMBER)] = 1

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.actuators.relax_winch(self.winch, timeout=self.timeout)


class Beep(Action):
    """Sound the beeper."""

    tune: Annotated[str, Meta(description="The notes, as QBasic's PLAY.", max_length=MAX_TUNE)] = DEFAULT_TUNE

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.actuators.beep(self.tune)


class SetEkfSource(Action):
    """Select a set of sources of the estimator (ArduPilot)."""

    set: Annotated[int, Meta(description="The number of the set, 1 to 3.", ge=1, le=3, examples=[1])]

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.set_ekf_source(self.set, timeout=self.timeout)


class PointAt(Action):
    """Keep pointing at a place."""

    latitude: Latitude
    longitude: Longitude
    altitude: Annotated[float, Meta(description="Metres above home.")] = 0.0

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        place = (self.latitude, self.longitude, self.altitude)
        await vehicle.roi.set_location(*place, timeout=self.timeout)


class PointAhead(Action):
    """Point ahead again."""

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.roi.clear(timeout=self.timeout)


#: The action at the end of each path.
ACTIONS: Final[dict[str, type[Action]]] = {
    "motor-test": RunMotor,
    "servo": SetServo,
    "relay": SetRelay,
    "actuator": SetActuator,
    "gripper": MoveGripper,
    "winch": UnwindWinch,
    "winch/run": RunWinch,
    "winch/relax": RelaxWinch,
    "beep": Beep,
    "ekf-source": SetEkfSource,
    "roi": PointAt,
    "roi/clear": PointAhead,
}
#: Actions that change the set-up of a vehicle, or run its motors on the bench.
_ADMINISTRATIVE: Final = frozenset({RunMotor, SetEkfSource})

ROUTES: Final = tuple(
    action_route(name, action, Role.ADMINISTER if action in _ADMINISTRATIVE else Role.OPERATE)
    for name, action in ACTIONS.items()
)
