"""The actions of a flight: arm, takeoff, goto and others; and any command."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, TypeAlias

from msgspec import Meta
from msgspec.structs import asdict

from mavstack.dialects import ardupilotmega, common
from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait
from mavstack.security.roles import Role, allows
from mavstack.server.api.action_route import Action, action_route
from mavstack.server.api_route import AnyRoute, ApiRoute, Call
from mavstack.server.json_values import to_json
from mavstack.server.request_types import Degrees90, Degrees180, Latitude, Longitude, Text, Timeout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.vehicle import Vehicle

_COMMAND_LONG: Final = 76
OverrideLimits: TypeAlias = Annotated[
    bool, Meta(description="Allow a position or an altitude beyond the limits of plausible flights.")
]
Altitude: TypeAlias = Annotated[
    float | None, Meta(description="Metres above home; null keeps the present altitude.", examples=[30.0])
]
Tolerance: TypeAlias = Annotated[
    float | None,
    Meta(description="Metres from the target at which the vehicle has arrived; null: that of its type."),
]


class Arm(Action):
    """Arm a vehicle."""

    force: Annotated[bool, Meta(description="Skip the firmware's checks.")] = False
    allow_flight: Annotated[
        bool, Meta(description="Arm in a mode in which the vehicle starts to fly or drive at once.")
    ] = False
    keep_mode: Annotated[
        bool, Meta(description="Refuse instead of leaving a mode in which the firmware does not arm.")
    ] = False

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.arm(**asdict(self))


class Disarm(Action):
    """Disarm a vehicle."""

    force: Annotated[bool, Meta(description="Skip the firmware's checks.")] = False

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.disarm(**asdict(self))


class Takeoff(Action):
    """Take off."""

    altitude: Annotated[float, Meta(description="Metres above home.", examples=[15.0])] = 10.0
    tolerance: Tolerance = None
    override_limits: OverrideLimits = False

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.takeoff(**asdict(self), wait=wait)


class Land(Action):
    """Land at the present position."""

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.land(**asdict(self), wait=wait)


class ReturnHome(Action):
    """Return to home."""

    tolerance: Tolerance = None

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.rtl(**asdict(self), wait=wait)


class Hold(Action):
    """Hold the present position."""

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.hold(**asdict(self))


class Goto(Action):
    """Go to a position."""

    latitude: Latitude
    longitude: Longitude
    altitude: Altitude = None
    yaw: Annotated[float | None, Meta(description="Heading in degrees; null leaves it to the vehicle.")] = (
        None
    )
    radius: Annotated[
        float | None, Meta(description="Metres of the circle that a wing flies around the position.")
    ] = None
    tolerance: Tolerance = None
    override_limits: OverrideLimits = False

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.goto(**asdict(self), wait=wait)


class Move(Action):
    """Move by a distance."""

    north: Annotated[float, Meta(description="Metres to the north.")] = 0.0
    east: Annotated[float, Meta(description="Metres to the east.")] = 0.0
    up: Annotated[float, Meta(description="Metres upwards.")] = 0.0
    tolerance: Tolerance = None
    override_limits: OverrideLimits = False

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.move(**asdict(self), wait=wait)


class Orbit(Action):
    """Circle a position."""

    latitude: Latitude
    longitude: Longitude
    altitude: Altitude = None
    radius: Annotated[float, Meta(description="Metres; negative: counter-clockwise.")] = 20.0
    speed: Annotated[float | None, Meta(description="Metres per second; null leaves it to the vehicle.")] = (
        None
    )
    tolerance: Annotated[
        float | None,
        Meta(description="Metres by which radius and altitude may differ; null: a part of the radius."),
    ] = None
    override_limits: OverrideLimits = False

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.orbit(**asdict(self), wait=wait)


class SetSpeed(Action):
    """Set the speed of flight."""

    speed: Annotated[float, Meta(description="Metres per second over ground.", examples=[8.0])]

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.set_speed(self.speed, timeout=self.timeout)


class ChangeAltitude(Action):
    """Change the altitude at the present position."""

    altitude: Annotated[float, Meta(description="Metres above home.", examples=[30.0])]
    tolerance: Tolerance = None
    override_limits: OverrideLimits = False

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        if not vehicle.vehicle_type.has_altitude:
            raise vehicle.firmware.unsupported("change its altitude")
        position = await vehicle.get_position()
        await vehicle.goto(position.latitude, position.longitude, **asdict(self), wait=wait)


class SetYaw(Action):
    """Turn to a heading."""

    heading: Annotated[float, Meta(description="Degrees from north.", examples=[90.0])]

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.set_yaw(**asdict(self), wait=wait)


class SetMode(Action):
    """Set the flight mode."""

    mode: Annotated[int | Text, Meta(description="The name of a mode, or its number.", examples=["GUIDED"])]

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.set_mode(self.mode, timeout=self.timeout)


class SetHome(Action):
    """Set the home position."""

    latitude: Annotated[
        Degrees90 | None, Meta(description="Degrees; null: the present position.", examples=[47.398])
    ] = None
    longitude: Annotated[Degrees180 | None, Meta(description="Degrees.", examples=[8.546])] = None
    altitude: Annotated[
        float | None, Meta(description="Metres above mean sea level; null keeps it.", examples=[30.0])
    ] = None

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.set_home(**asdict(self))


class Transition(Action):
    """Change a VTOL to its wing or to its rotors."""

    to: Annotated[
        Literal["fixed-wing", "multicopter"],
        Meta(description="The state to change to.", examples=["fixed-wing"]),
    ]

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        to_wing = self.to == "fixed-wing"
        change = vehicle.transition_to_fixed_wing if to_wing else vehicle.transition_to_multicopter
        await change(timeout=self.timeout, wait=wait)


class Reboot(Action):
    """Reboot the autopilot."""

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.reboot(**asdict(self), wait=wait)


class Terminate(Action):
    """Terminate the flight: the vehicle crashes."""

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.terminate(**asdict(self))


class StartMission(Action):
    """Fly the mission."""

    arm: Annotated[bool, Meta(description="Arm the vehicle first.")] = False

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.mission.start(**asdict(self))


class PauseMission(Action):
    """Pause the mission."""

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.mission.pause(**asdict(self))


class SetCurrentItem(Action):
    """Set the next mission item."""

    seq: Annotated[int, Meta(description="The number of the item.", ge=0, examples=[2])]
    restart: Annotated[bool, Meta(description="Start the mission again.")] = False

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.mission.set_current(**asdict(self))


#: The action at the end of each path.
ACTIONS: Final[dict[str, type[Action]]] = {
    "arm": Arm,
    "disarm": Disarm,
    "takeoff": Takeoff,
    "land": Land,
    "rtl": ReturnHome,
    "hold": Hold,
    "goto": Goto,
    "move": Move,
    "orbit": Orbit,
    "speed": SetSpeed,
    "altitude": ChangeAltitude,
    "yaw": SetYaw,
    "mode": SetMode,
    "home": SetHome,
    "transition": Transition,
    "reboot": Reboot,
    "terminate": Terminate,
    "mission/start": StartMission,
    "mission/pause": PauseMission,
    "mission/current": SetCurrentItem,
}
#: Actions that need the role `administer`, as they are not part of a flight.
_ADMINISTRATIVE: Final = frozenset({Reboot})


class SendCommand(Fields):
    """Send any command."""

    command: Annotated[
        float | Text, Meta(description="The MAV_CMD, by name or number.", examples=["DO_SET_RELAY"])
    ]
    params: Annotated[
        Annotated[tuple[float | None, ...], Meta(max_length=7)],
        Meta(description="Up to seven numbers; null is NaN, missing ones are 0.", examples=[[0, 1]]),
    ] = ()
    frame: Annotated[
        Annotated[int, Meta(ge=0, le=255)] | None,
        Meta(description="A MAV_FRAME: send COMMAND_INT; null: COMMAND_LONG."),
    ] = None
    timeout: Timeout = None


ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "actions")


@ROUTES.add(
    "POST",
    "/api/vehicles/{system}/command",
    role=Role.OPERATE,
    answer={"system": 1, "command": 181, "result": {"result": "ACCEPTED"}},
)
async def _command(call: Call[SendCommand, Wait]) -> dict[str, Any]:
    vehicle, body = call.vehicle, call.body
    number = command_number(vehicle, body.command)
    if not allows(call.role, _COMMAND_LONG, number):
        raise RefusedError(403, f"the role {call.role.word} may not send the command {body.command}")
    result = await vehicle.command(
        number,
        *_params(body.params),
        frame=body.frame,
        timeout=body.timeout,
        progress=call.progress,
    )
    known = result.result in common.MavResult.__members__.values()
    name = common.MavResult(result.result) if known else result.result
    values = {"result": to_json(name), "detail": result.detail, "attempts": result.attempts}
    return {"system": vehicle.system, "command": number, "result": values}


def command_number(vehicle: Vehicle, command: str | float) -> int:
    """Return the number of a MAV_CMD, also one of ArduPilot's own, from its name or number.

    Raises:
        RefusedError: There is no such command.
    """
    if isinstance(command, str):
        name = command.upper().removeprefix("MAV_CMD_")
        found = ardupilotmega.MavCmd.__members__.get(name)
        if found is None:
            raise RefusedError(400, f"there is no command {command[:60]!r}")
        return int(found)
    if command != int(command) or not 0 <= command <= 0xFFFF:
        raise RefusedError(400, f"command must be a name or a number from 0 to 65535, got {command!r}")
    return int(command)


def _params(values: Sequence[float | None]) -> list[float]:
    return [float("nan") if each is None else each for each in values]


ROUTES.extend(
    (
        action_route(name, action, Role.ADMINISTER if action in _ADMINISTRATIVE else Role.OPERATE)
        for name, action in ACTIONS.items()
    )
)
