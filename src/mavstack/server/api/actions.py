"""The actions of a flight: arm, takeoff, goto and others; and any command."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role, allows
from mavstack.server.api.action_route import TIMEOUT, action_route
from mavstack.server.api_route import ApiRoute, Call
from mavstack.server.fields import Field
from mavstack.server.json_values import to_json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.server.api.action_route import Action
    from mavstack.vehicle import Vehicle

MAX_PARAMS: Final = 7
_COMMAND_LONG: Final = 76
_LATITUDE = Field(name="latitude", about="Degrees.", required=True, minimum=-90, maximum=90, example=47.398)
_LONGITUDE = Field(
    name="longitude", about="Degrees.", required=True, minimum=-180, maximum=180, example=8.546
)
_ALTITUDE = Field(name="altitude", about="Metres above home; null keeps the present altitude.", example=30.0)
_FORCE = Field(name="force", type="boolean", about="Skip the firmware's checks.", default=False)
_ALLOW_FLIGHT = Field(
    name="allow_flight",
    type="boolean",
    about="Arm in a mode in which the vehicle starts to fly or drive at once.",
    default=False,
)
_KEEP_MODE = Field(
    name="keep_mode",
    type="boolean",
    about="Refuse instead of leaving a mode in which the firmware does not arm.",
    default=False,
)
_OVERRIDE = Field(
    name="override_limits",
    type="boolean",
    about="Allow a position or an altitude beyond the limits of plausible flights.",
    default=False,
)
_TOLERANCE = Field(
    name="tolerance",
    about="Metres from the target at which the vehicle has arrived; null: the default of its type.",
)
#: Actions beyond a flight.
_ADMINISTRATIVE: Final = frozenset({"reboot"})


async def _arm(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.arm(**body)


async def _disarm(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.disarm(force=body["force"], timeout=body["timeout"])


async def _takeoff(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.takeoff(**body, wait=wait)


async def _land(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.land(**body, wait=wait)


async def _rtl(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.rtl(**body, wait=wait)


async def _hold(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.hold(**body)


async def _goto(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.goto(**body, wait=wait)


async def _move(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.move(**body, wait=wait)


async def _orbit(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.orbit(**body, wait=wait)


async def _speed(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.set_speed(body["speed"], timeout=body["timeout"])


async def _yaw(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.set_yaw(**body, wait=wait)


async def _altitude(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    if not vehicle.vehicle_type.has_altitude:
        raise vehicle.firmware.unsupported("change its altitude")
    position = await vehicle.get_position()
    await vehicle.goto(position.latitude, position.longitude, **body, wait=wait)


async def _mode(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.set_mode(body["mode"], timeout=body["timeout"])


async def _home(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.set_home(**body)


async def _transition(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    to_wing = body["to"] == "fixed-wing"
    change = vehicle.transition_to_fixed_wing if to_wing else vehicle.transition_to_multicopter
    await change(timeout=body["timeout"], wait=wait)


async def _reboot(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.reboot(**body, wait=wait)


async def _terminate(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.terminate(**body)


async def _start_mission(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.mission.start(**body)


async def _pause_mission(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.mission.pause(**body)


async def _set_current(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.mission.set_current(**body)


_NORTH, _EAST, _UP = (
    Field(name=name, about=f"Metres {direction}.", default=0.0)
    for name, direction in (("north", "to the north"), ("east", "to the east"), ("up", "upwards"))
)

#: Each action: its function, its summary and the fields of its body; all have `timeout`.
ACTIONS: Final[dict[str, tuple[Action, str, tuple[Field, ...]]]] = {
    "arm": (_arm, "Arm a vehicle", (_FORCE, _ALLOW_FLIGHT, _KEEP_MODE)),
    "disarm": (_disarm, "Disarm a vehicle", (_FORCE,)),
    "takeoff": (
        _takeoff,
        "Take off",
        (Field(name="altitude", about="Metres above home.", default=10.0, example=15.0), _OVERRIDE),
    ),
    "land": (_land, "Land at the present position", ()),
    "rtl": (_rtl, "Return to home", (_TOLERANCE,)),
    "hold": (_hold, "Hold the present position", ()),
    "goto": (
        _goto,
        "Go to a position",
        (
            _LATITUDE,
            _LONGITUDE,
            _ALTITUDE,
            Field(name="yaw", about="Heading in degrees; null leaves it to the vehicle."),
            Field(name="radius", about="Metres of the circle that a wing flies around the position."),
            _TOLERANCE,
            _OVERRIDE,
        ),
    ),
    "move": (_move, "Move by a distance", (_NORTH, _EAST, _UP, _TOLERANCE, _OVERRIDE)),
    "orbit": (
        _orbit,
        "Circle a position",
        (
            _LATITUDE,
            _LONGITUDE,
            _ALTITUDE,
            Field(name="radius", about="Metres; negative: counter-clockwise.", default=20.0),
            Field(name="speed", about="Metres per second; null leaves it to the vehicle."),
            replace(
                _TOLERANCE,
                about="Metres by which radius and altitude may differ; null: a part of the radius.",
            ),
            _OVERRIDE,
        ),
    ),
    "speed": (
        _speed,
        "Set the speed of flight",
        (Field(name="speed", about="Metres per second over ground.", required=True, example=8.0),),
    ),
    "altitude": (
        _altitude,
        "Change the altitude at the present position",
        (replace(_ALTITUDE, about="Metres above home.", required=True), _TOLERANCE, _OVERRIDE),
    ),
    "yaw": (
        _yaw,
        "Turn to a heading",
        (Field(name="heading", about="Degrees from north.", required=True, example=90.0),),
    ),
    "mode": (
        _mode,
        "Set the flight mode",
        (
            Field(
                name="mode",
                type="value",
                about="The name of a mode, or its number.",
                required=True,
                example="GUIDED",
            ),
        ),
    ),
    "home": (
        _home,
        "Set the home position",
        (
            replace(_LATITUDE, required=False, about="Degrees; null: the present position."),
            replace(_LONGITUDE, required=False),
            replace(_ALTITUDE, about="Metres above mean sea level; null keeps it."),
        ),
    ),
    "transition": (
        _transition,
        "Change a VTOL to its wing or to its rotors",
        (
            Field(
                name="to",
                type="string",
                about="The state to change to.",
                required=True,
                choices=("fixed-wing", "multicopter"),
                example="fixed-wing",
            ),
        ),
    ),
    "reboot": (_reboot, "Reboot the autopilot", ()),
    "terminate": (_terminate, "Terminate the flight: the vehicle crashes", ()),
    "mission/start": (
        _start_mission,
        "Fly the mission",
        (Field(name="arm", type="boolean", about="Arm the vehicle first.", default=False),),
    ),
    "mission/pause": (_pause_mission, "Pause the mission", ()),
    "mission/current": (
        _set_current,
        "Set the next mission item",
        (
            Field(
                name="seq",
                type="integer",
                about="The number of the item.",
                required=True,
                minimum=0,
                example=2,
            ),
            Field(name="restart", type="boolean", about="Start the mission again.", default=False),
        ),
    ),
}


async def _command(call: Call) -> dict[str, Any]:
    vehicle, body = call.vehicle, call.body
    number = command_number(vehicle, body["command"])
    if not allows(call.role, _COMMAND_LONG, number):
        raise RefusedError(403, f"the role {call.role.word} may not send the command {body['command']}")
    result = await vehicle.command(
        number,
        *_params(body["params"]),
        frame=body["frame"],
        timeout=body["timeout"],
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


def _params(values: Sequence[Any]) -> list[float]:
    if len(values) > MAX_PARAMS:
        raise RefusedError(400, f"params must have at most {MAX_PARAMS} numbers, got {len(values)}")
    if not all(
        isinstance(each, int | float) and not isinstance(each, bool) for each in values if each is not None
    ):
        raise RefusedError(400, "params must be numbers, or null for NaN")
    return [float("nan") if each is None else float(each) for each in values]


ROUTES: Final = (
    *(
        action_route(name, *action, role=Role.ADMINISTER if name in _ADMINISTRATIVE else Role.OPERATE)
        for name, action in ACTIONS.items()
    ),
    ApiRoute(
        method="POST",
        path="/api/vehicles/{system}/command",
        handler=_command,
        summary="Send any command",
        tag="actions",
        role=Role.OPERATE,
        body=(
            Field(
                name="command",
                type="value",
                about="The MAV_CMD, by name or number.",
                required=True,
                example="DO_SET_RELAY",
            ),
            Field(
                name="params",
                type="array",
                about="Up to seven numbers; null is NaN, missing ones are 0.",
                default=(),
                example=[0, 1],
            ),
            Field(
                name="frame",
                type="integer",
                about="A MAV_FRAME: send COMMAND_INT; null: COMMAND_LONG.",
                minimum=0,
                maximum=255,
            ),
            TIMEOUT,
        ),
        is_long=True,
        answer={"system": 1, "command": 181, "result": {"result": "ACCEPTED"}},
    ),
)
