"""Commands as JSON: a verb, an object with its arguments, an object as the answer.

    arm      {}                       → {"ok": true}
    takeoff  {"altitude": 10}         → {"ok": true}
    arm      {}                       → {"ok": false, "reason": "arming 1/1 failed: FAILED (PreArm: …)", …}

An answer comes when the vehicle has done it. Nothing raises: whatever is not valid is answered.
"""

from __future__ import annotations

import json
import logging
from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.endpoints import NO_CONTROL
from mavstack.bridges.core.plain_json import parse_object, plain
from mavstack.errors import InvalidArgumentError, InvalidStateError, MavstackError
from mavstack.files.plans import parse_plan
from mavstack.security.roles import Role
from mavstack.services.mission import PlanType

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping

    from mavstack.services.parameters import Parameter
    from mavstack.vehicle import Vehicle

logger = logging.getLogger("mavstack.bridges")
Fields = dict[str, Any]
_NUMBER, _TEXT, _FLAG, _OBJECT = "number", "text", "true or false", "object"
_WHOLE = "whole number"


@dataclass(frozen=True, slots=True)
class Verb:
    """A command.

    Attributes:
        run: Calls the vehicle; returns the result for the answer, or None.
        role: The role that may use it.
        needed: The arguments that it needs, with their kinds.
        optional: The arguments that it may have.
        meaning: One line about it, for tables.
    """

    run: Callable[[Vehicle, Fields], Awaitable[Fields | None]]
    role: Role = Role.OPERATE
    needed: Mapping[str, str] = field(default_factory=dict)
    optional: Mapping[str, str] = field(default_factory=dict)
    meaning: str = ""


async def answer(vehicle: Vehicle, name: str, payload: bytes, role: Role) -> Fields:
    """Carry out a command.

    Args:
        vehicle: The vehicle.
        name: The verb.
        payload: A JSON object with the arguments; empty: none.
        role: The role of the bus.

    Returns:
        `ok`, and the result, or the reason with the class of the error and the vehicle's own code.
    """
    try:
        verb = VERBS.get(name)
        if verb is None:
            raise InvalidArgumentError(f"there is no command {name!r:.40}: {', '.join(VERBS)}")
        if verb.role > role:
            raise InvalidStateError(_not_allowed(name, verb.role, role))
        result = await verb.run(vehicle, _arguments(name, verb, payload))
    except Exception as error:  # noqa: BLE001 (a request may hold anything)
        return failure(error)
    return {"ok": True} if result is None else {"ok": True, "result": result}


def failure(error: Exception) -> Fields:
    """Return the answer for an error."""
    text = str(error) or type(error).__name__
    if not isinstance(error, MavstackError):
        logger.debug("a command failed", exc_info=error)
    found: Fields = {"ok": False, "reason": text, "kind": type(error).__name__}
    code = getattr(error, "code", None)
    if isinstance(code, int):
        found["code"] = int(code)
    return found


def _not_allowed(name: str, needed: Role, role: Role) -> str:
    if role is Role.OBSERVE:
        return f"{name} refused: {NO_CONTROL}"
    return f"{name} refused: it needs the role {needed.word}, the bridge has {role.word}"


def _arguments(name: str, verb: Verb, payload: bytes) -> Fields:
    """Return the checked arguments; raises InvalidArgumentError."""
    found = parse_object(payload)
    known = {**verb.needed, **verb.optional}
    for key, value in found.items():
        if key not in known:
            raise InvalidArgumentError(f"{name} has no argument {key!r:.40}: {', '.join(known) or 'none'}")
        if value is not None and not _is_kind(value, known[key]):
            raise InvalidArgumentError(f"{name}: {key} must be a {known[key]}, got {value!r:.40}")
    for key in verb.needed:
        if found.get(key) is None:
            raise InvalidArgumentError(f"{name} needs {key}, a {verb.needed[key]}")
    return {key: value for key, value in found.items() if value is not None}


def _is_kind(value: object, kind: str) -> bool:
    if kind == _FLAG:
        return isinstance(value, bool)
    is_number = isinstance(value, int | float) and not isinstance(value, bool) and _is_finite(value)
    if kind in (_NUMBER, _WHOLE):
        return is_number and (kind == _NUMBER or value == int(value))  # type: ignore[call-overload]
    return isinstance(value, str if kind == _TEXT else dict)


def _is_finite(value: float) -> bool:
    try:
        return isfinite(value)
    except OverflowError:  # an integer that is too large for a float
        return False


# The verbs


async def _upload_mission(vehicle: Vehicle, given: Fields) -> Fields:
    home_first = vehicle.component.mission.home_first
    plan = parse_plan(json.dumps(given["plan"])).for_vehicle(PlanType.MISSION, home_first=home_first)
    return {"items": len(await vehicle.mission.upload(plan))}


async def _get_parameter(vehicle: Vehicle, given: Fields) -> Fields:
    return _value_of(await vehicle.params.get(given["name"]))


async def _set_parameter(vehicle: Vehicle, given: Fields) -> Fields:
    return _value_of(await vehicle.params.set(given["name"], given["value"]))


def _value_of(parameter: Parameter) -> Fields:
    """Return a parameter as JSON has it."""
    return {"name": parameter.name, "value": plain(parameter.value)}


_WAIT: Final = {"wait": _FLAG}
_PLACE: Final = {"latitude": _NUMBER, "longitude": _NUMBER}
#: The commands by name.
VERBS: Final[Mapping[str, Verb]] = {
    "arm": Verb(
        lambda vehicle, given: vehicle.arm(**given), optional={"force": _FLAG}, meaning="arm the motors"
    ),
    "disarm": Verb(
        lambda vehicle, given: vehicle.disarm(**given), optional={"force": _FLAG}, meaning="disarm the motors"
    ),
    "mode": Verb(
        lambda vehicle, given: vehicle.set_mode(given["mode"]),
        needed={"mode": _TEXT},
        meaning="change the flight mode",
    ),
    "takeoff": Verb(
        lambda vehicle, given: vehicle.takeoff(**given),
        needed={"altitude": _NUMBER},
        optional=_WAIT,
        meaning="take off, metres above home",
    ),
    "land": Verb(lambda vehicle, given: vehicle.land(**given), optional=_WAIT, meaning="land"),
    "rtl": Verb(lambda vehicle, given: vehicle.rtl(**given), optional=_WAIT, meaning="return to home"),
    "hold": Verb(lambda vehicle, _: vehicle.hold(), meaning="hold the position"),
    "goto": Verb(
        lambda vehicle, given: vehicle.goto(**given),
        needed=_PLACE,
        optional={"altitude": _NUMBER, "yaw": _NUMBER, **_WAIT},
        meaning="fly to degrees, metres above home, yaw in degrees from north",
    ),
    "speed": Verb(
        lambda vehicle, given: vehicle.set_speed(given["speed"]),
        needed={"speed": _NUMBER},
        meaning="change the ground speed, m/s",
    ),
    "mission_upload": Verb(
        _upload_mission, needed={"plan": _OBJECT}, meaning="replace the mission by a plan of QGroundControl"
    ),
    "mission_start": Verb(
        lambda vehicle, given: vehicle.mission.start(**given),
        optional={"arm": _FLAG},
        meaning="start the mission",
    ),
    "mission_pause": Verb(lambda vehicle, _: vehicle.mission.pause(), meaning="pause the mission"),
    "mission_clear": Verb(lambda vehicle, _: vehicle.mission.clear(), meaning="remove the mission"),
    "mission_item": Verb(
        lambda vehicle, given: vehicle.mission.set_current(int(given["item"])),
        needed={"item": _WHOLE},
        meaning="continue with an item",
    ),
    "param_get": Verb(_get_parameter, Role.OBSERVE, needed={"name": _TEXT}, meaning="read a parameter"),
    "param_set": Verb(
        _set_parameter,
        Role.ADMINISTER,
        needed={"name": _TEXT, "value": _NUMBER},
        meaning="write a parameter",
    ),
    "reboot": Verb(
        lambda vehicle, given: vehicle.reboot(**given),
        Role.ADMINISTER,
        optional=_WAIT,
        meaning="reboot the autopilot",
    ),
}
