"""The equipment of a vehicle: motors on the bench, servos, relays, gripper, winch, beeper, pointing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.security.roles import Role
from mavstack.server.api.action_route import action_route
from mavstack.server.fields import Field
from mavstack.vehicle.actuators import DEFAULT_TUNE, MAX_TUNE

if TYPE_CHECKING:
    from mavstack.server.api.action_route import Action
    from mavstack.vehicle import Vehicle

MAX_NUMBER: Final = 255


def _number(
    name: str, about: str, default: int | None = None, *, minimum: int = 1, maximum: int = MAX_NUMBER
) -> Field:
    return Field(
        name=name,
        type="integer",
        about=about,
        required=default is None,
        default=default,
        minimum=minimum,
        maximum=maximum,
        example=1 if default is None else None,
    )


async def _test_motor(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    number, timeout = body["motor"], body["timeout"]
    throttle, duration = body["throttle"], body["duration"]
    await vehicle.actuators.test_motor(
        number, throttle=throttle, duration=duration, wait=wait, timeout=timeout
    )


async def _servo(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.actuators.set_servo(body["servo"], body["pulse"], timeout=body["timeout"])


async def _relay(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.actuators.set_relay(body["relay"], body["on"], timeout=body["timeout"])


async def _actuator(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.actuators.set_actuator(body["actuator"], body["value"], timeout=body["timeout"])


async def _gripper(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    actuators = vehicle.actuators
    move = actuators.release if body["open"] else actuators.grip
    await move(body["gripper"], timeout=body["timeout"])


async def _winch(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.actuators.unwind(
        body["length"], rate=body["rate"], winch=body["winch"], wait=wait, timeout=body["timeout"]
    )


async def _beep(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.actuators.beep(body["tune"])


async def _ekf_source(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.set_ekf_source(body["set"], timeout=body["timeout"])


async def _roi(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    place = (body["latitude"], body["longitude"], body["altitude"])
    await vehicle.roi.set_location(*place, timeout=body["timeout"])


async def _clear_roi(vehicle: Vehicle, body: dict[str, Any], wait: bool) -> None:
    await vehicle.roi.clear(timeout=body["timeout"])


#: Each action: its function, its summary, the fields of its body, and the role that it needs.
ACTIONS: Final[dict[str, tuple[Action, str, tuple[Field, ...], Role]]] = {
    "motor-test": (
        _test_motor,
        "Run one motor of a disarmed vehicle, without propellers",
        (
            _number("motor", "The number of the motor, from 1."),
            Field(name="throttle", about="Percent.", default=5.0, minimum=0, maximum=100),
            Field(name="duration", about="Seconds.", default=2.0, minimum=0, maximum=600),
        ),
        Role.ADMINISTER,
    ),
    "servo": (
        _servo,
        "Set the pulse of a servo output (ArduPilot)",
        (
            _number("servo", "The number of the output, from 1."),
            Field(name="pulse", type="integer", about="Microseconds.", required=True, example=1500),
        ),
        Role.OPERATE,
    ),
    "relay": (
        _relay,
        "Switch a relay (ArduPilot)",
        (
            _number("relay", "The number of the relay, from 0.", minimum=0),
            Field(name="on", type="boolean", about="True switches it on.", required=True, example=True),
        ),
        Role.OPERATE,
    ),
    "actuator": (
        _actuator,
        "Set an actuator output (PX4)",
        (
            _number("actuator", "The number of the actuator, from 1."),
            Field(name="value", about="From -1 to 1.", required=True, minimum=-1, maximum=1, example=0.5),
        ),
        Role.OPERATE,
    ),
    "gripper": (
        _gripper,
        "Open or close a gripper",
        (
            Field(name="open", type="boolean", about="True opens it.", required=True, example=True),
            _number("gripper", "The number of the gripper, from 1.", 1),
        ),
        Role.OPERATE,
    ),
    "winch": (
        _winch,
        "Pay out line from a winch, or wind it in",
        (
            Field(name="length", about="Metres; negative: wind in.", required=True, example=2.0),
            Field(name="rate", about="Metres per second; 0: as the vehicle likes.", default=0.0),
            _number("winch", "The number of the winch, from 1.", 1),
        ),
        Role.OPERATE,
    ),
    "beep": (
        _beep,
        "Sound the beeper",
        (
            Field(
                name="tune",
                type="string",
                about="The notes, as QBasic's PLAY.",
                default=DEFAULT_TUNE,
                max_length=MAX_TUNE,
            ),
        ),
        Role.OPERATE,
    ),
    "ekf-source": (
        _ekf_source,
        "Select a set of sources of the estimator (ArduPilot)",
        (_number("set", "The number of the set, 1 to 3.", maximum=3),),
        Role.ADMINISTER,
    ),
    "roi": (
        _roi,
        "Keep pointing at a place",
        (
            Field(name="latitude", about="Degrees.", required=True, minimum=-90, maximum=90, example=47.398),
            Field(
                name="longitude", about="Degrees.", required=True, minimum=-180, maximum=180, example=8.546
            ),
            Field(name="altitude", about="Metres above home.", default=0.0),
        ),
        Role.OPERATE,
    ),
    "roi/clear": (_clear_roi, "Point ahead again", (), Role.OPERATE),
}

ROUTES: Final = tuple(
    action_route(name, action, summary, fields, role)
    for name, (action, summary, fields, role) in ACTIONS.items()
)
