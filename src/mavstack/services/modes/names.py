"""Names of flight modes: the meaning of `custom_mode` in HEARTBEAT for each autopilot.

ArduPilot numbers its modes per vehicle type; most numbers are enums of its dialect, the missing ones are
defined here. PX4 has the same numbers for every vehicle, in the two upper bytes: a main mode, and for some
main modes a sub mode. The numbers of other autopilots have no common names.

A mode has one name everywhere: that of these tables, or, for a mode that they do not have, such as an
external mode of PX4 or a scripted one of ArduPilot, the name in the vehicle's AVAILABLE_MODES. PX4 leaves
that name empty for standard modes, and calls some modes otherwise than the tables.

Names are matched without regard to case, blanks, hyphens and underscores, and the short names of ArduPilot's
own tools are accepted too.
"""

from __future__ import annotations

import re
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import Dialect, common

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

ARDUPILOT: Final = common.MavAutopilot.ARDUPILOTMEGA
PX4: Final = common.MavAutopilot.PX4

_T: Final = common.MavType
#: The vehicle types that share the modes of one ArduPilot firmware; boats use the modes of the rover.
_FAMILIES: Final[Mapping[str, frozenset[int]]] = MappingProxyType(
    {
        "COPTER_MODE": frozenset(
            {
                _T.QUADROTOR, _T.COAXIAL, _T.HELICOPTER, _T.HEXAROTOR, _T.OCTOROTOR, _T.TRICOPTER,
                _T.DODECAROTOR, _T.DECAROTOR, _T.GENERIC_MULTIROTOR,
            }
        ),
        "PLANE_MODE": frozenset(
            {
                _T.FIXED_WING, _T.VTOL_TAILSITTER_DUOROTOR, _T.VTOL_TAILSITTER_QUADROTOR, _T.VTOL_TILTROTOR,
                _T.VTOL_FIXEDROTOR, _T.VTOL_TAILSITTER, _T.VTOL_TILTWING, _T.VTOL_RESERVED5,
            }
        ),
        "ROVER_MODE": frozenset({_T.GROUND_ROVER, _T.SURFACE_BOAT}),
        "SUB_MODE": frozenset({_T.SUBMARINE}),
        "TRACKER_MODE": frozenset({_T.ANTENNA_TRACKER}),
        "BLIMP_MODE": frozenset({_T.AIRSHIP}),
    }
)  # fmt: skip
#: Modes that are missing in the enums of the dialect.
_MORE_ARDUPILOT_MODES: Final[Mapping[str, Mapping[int, str]]] = MappingProxyType(
    {
        "COPTER_MODE": {29: "RATE_ACRO"},
        "BLIMP_MODE": dict(enumerate(("LAND", "MANUAL", "VELOCITY", "LOITER", "RTL", "AUTO", "HOLD"))),
    }
)
_OTHER_ARDUPILOT_NAMES: Final[Mapping[str, str]] = MappingProxyType(
    {"FBWA": "FLY_BY_WIRE_A", "FBWB": "FLY_BY_WIRE_B", "INITIALISING": "INITIALIZING"}
)

#: Modes that programs register with PX4 at run time.
_EXTERNAL: Final = "EXTERNAL"
_PX4_POSCTL: Final = 3
_PX4_AUTO: Final = 4
_PX4_MAIN_MODES: Final[Mapping[int, str]] = MappingProxyType(
    {
        1: "MANUAL",
        2: "ALTCTL",
        _PX4_POSCTL: "POSCTL",
        _PX4_AUTO: "AUTO",
        5: "ACRO",
        6: "OFFBOARD",
        7: "STABILIZED",
        8: "RATTITUDE",
        9: "SIMPLE",
        10: "TERMINATION",
        11: "ALTITUDE_CRUISE",
    }
)
_PX4_SUB_MODES: Final[Mapping[int, Mapping[int, str]]] = MappingProxyType(
    {
        _PX4_POSCTL: {1: "ORBIT", 2: "POSITION_SLOW"},
        _PX4_AUTO: {
            1: "READY",
            2: "TAKEOFF",
            3: "LOITER",
            4: "MISSION",
            5: "RTL",
            6: "LAND",
            8: "FOLLOW_TARGET",
            9: "PRECLAND",
            10: "VTOL_TAKEOFF",
            **{10 + number: f"{_EXTERNAL}{number}" for number in range(1, 9)},
        },
    }
)
_OTHER_PX4_NAMES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "HOLD": "LOITER",
        "RETURN": "RTL",
        "ALTITUDE": "ALTCTL",
        "POSITION": "POSCTL",
        "FOLLOWME": "FOLLOW_TARGET",
    }
)

#: Names of modes that a user cannot enter: a main mode without its sub mode, modes of earlier versions,
#: external modes without a name, and the state of a vehicle that is starting.
_PX4_PLACEHOLDERS: Final = frozenset({"AUTO", "READY", "RATTITUDE", "SIMPLE"})
_ARDUPILOT_PLACEHOLDERS: Final = frozenset({"INITIALIZING"})
#: A name that consists of a general word and a number: "mode 17", "EXTERNAL3", "Reserved 5".
_NUMBER_ONLY: Final = re.compile(r"(mode|external|reserved|unused|unknown)?[ _]*\(?\d*\)?", re.IGNORECASE)


def is_placeholder(autopilot: int, name: str) -> bool:
    """Return whether a name of a list of modes stands for a number without a use."""
    placeholders = _PX4_PLACEHOLDERS if autopilot == PX4 else _ARDUPILOT_PLACEHOLDERS
    return name in placeholders or _NUMBER_ONLY.fullmatch(name) is not None


def px4_custom_mode(main: int, sub: int = 0) -> int:
    """Return PX4's `custom_mode` of a main mode and its sub mode."""
    return (sub & 0xFF) << 24 | (main & 0xFF) << 16


def px4_modes_of(custom_mode: int) -> tuple[int, int]:
    """Return the main mode and the sub mode in PX4's `custom_mode`."""
    return custom_mode >> 16 & 0xFF, custom_mode >> 24 & 0xFF


@cache
def mode_names(autopilot: int, vehicle: int) -> Mapping[int, str]:
    """Return the modes of a MAV_AUTOPILOT on a MAV_TYPE: names by `custom_mode`."""
    if autopilot == PX4:
        return MappingProxyType(dict(_px4_names()))
    if autopilot == ARDUPILOT:
        return MappingProxyType(dict(_ardupilot_names(vehicle)))
    return MappingProxyType({})


def mode_name(autopilot: int, vehicle: int, custom_mode: int) -> str | None:
    """Return the name of a mode; None if unknown."""
    names = mode_names(autopilot, vehicle)
    if autopilot == PX4 and custom_mode not in names:
        # If the sub mode is not known, the name of the main mode is returned.
        return names.get(px4_custom_mode(px4_modes_of(custom_mode)[0]))
    return names.get(custom_mode)


def listed_name(autopilot: int, vehicle: int, custom_mode: int, reported: str) -> str:
    """Return the name of a mode that the vehicle lists with the name `reported`, which may be empty."""
    known = mode_names(autopilot, vehicle).get(custom_mode)
    if known is None or (reported and known.startswith(_EXTERNAL)):
        return reported or known or f"mode {custom_mode}"
    return known


def same_name(one: str, other: str) -> bool:
    """Return whether two names of modes are the same but for case, blanks, hyphens and underscores."""
    return _plain(one) == _plain(other)


def mode_number(autopilot: int, vehicle: int, name: str) -> int | None:
    """Return the `custom_mode` of a mode's name; None if there is no such mode."""
    return _numbers(autopilot, vehicle).get(_plain(name))


@cache
def _numbers(autopilot: int, vehicle: int) -> Mapping[str, int]:
    numbers = {_plain(name): number for number, name in mode_names(autopilot, vehicle).items()}
    for other, name in (_OTHER_PX4_NAMES if autopilot == PX4 else _OTHER_ARDUPILOT_NAMES).items():
        if _plain(name) in numbers:
            numbers.setdefault(_plain(other), numbers[_plain(name)])
    return MappingProxyType(numbers)


def _ardupilot_names(vehicle: int) -> Iterator[tuple[int, str]]:
    family = next((name for name, vehicles in _FAMILIES.items() if vehicle in vehicles), "")
    enums = Dialect.load("ardupilotmega").enums
    if family in enums:
        yield from ((int(member.value), str(member.name)) for member in enums[family])
    yield from _MORE_ARDUPILOT_MODES.get(family, {}).items()


def _px4_names() -> Iterator[tuple[int, str]]:
    for main, name in _PX4_MAIN_MODES.items():
        yield px4_custom_mode(main), name
    for main, subs in _PX4_SUB_MODES.items():
        yield from ((px4_custom_mode(main, sub), name) for sub, name in subs.items())


def _plain(name: str) -> str:
    return name.upper().translate({ord(sign): None for sign in " -_"})
