"""The airframe: SYS_AUTOSTART of PX4, FRAME_CLASS and FRAME_TYPE of ArduPilot.

PX4 loads the defaults of an airframe when it starts. With SYS_AUTOCONFIG it first resets its parameters, so
that values of the old airframe do not stay; a few are kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.vehicle.actions.preconditions import refusal
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.vehicle import Vehicle

AUTOSTART, AUTOCONFIG = "SYS_AUTOSTART", "SYS_AUTOCONFIG"
FRAME_CLASS, FRAME_TYPE = "FRAME_CLASS", "FRAME_TYPE"
#: Parameters that PX4 keeps when it resets the others for another airframe.
PX4_KEEPS: Final = ("SYS_AUTOSTART", "CAL_*", "TC_*", "LND_FLIGHT*", "COM_FLIGHT*")
#: The names of PX4's airframes for boards that belong to no certain product.
PX4_AIRFRAMES: Final[Mapping[int, str]] = MappingProxyType(
    {
        2100: "standard plane",
        3000: "flying wing",
        4001: "quadcopter X",
        5001: "quadcopter +",
        6001: "hexacopter X",
        7001: "hexacopter +",
        8001: "octocopter X",
        9001: "octocopter +",
        11001: "hexacopter, coaxial",
        12001: "octocopter, coaxial",
        13000: "standard VTOL",
        13100: "VTOL with tilting rotors",
        13200: "VTOL tail-sitter",
        16001: "helicopter",
        50000: "rover, differential steering",
        51000: "rover, Ackermann steering",
        52000: "rover, mecanum wheels",
        60000: "underwater robot",
    }
)
COPTER_CLASSES: Final[Mapping[int, str]] = MappingProxyType(
    {
        0: "undefined",
        1: "quad",
        2: "hexa",
        3: "octa",
        4: "octa-quad",
        5: "Y6",
        6: "helicopter",
        7: "tri",
        8: "single",
        9: "coaxial",
        10: "bicopter",
        11: "helicopter, dual",
        12: "dodeca-hexa",
        13: "helicopter, quad",
        14: "deca",
    }
)
COPTER_TYPES: Final[Mapping[int, str]] = MappingProxyType(
    {
        0: "plus",
        1: "X",
        2: "V",
        3: "H",
        4: "V-tail",
        5: "A-tail",
        10: "Y6B",
        11: "Y6F",
        12: "Betaflight X",
        13: "DJI X",
        14: "clockwise X",
        15: "I",
        18: "Betaflight X, reversed",
    }
)
_ROVER_CLASSES: Final[Mapping[int, str]] = MappingProxyType(
    {0: "undefined", 1: "rover", 2: "boat", 3: "balance bot"}
)
_ROVER_TYPES: Final[Mapping[int, str]] = MappingProxyType(
    {0: "undefined", 1: "omni 3", 2: "omni X", 3: "omni +"}
)


@dataclass(frozen=True, slots=True)
class Airframe:
    """The airframe of a vehicle.

    Attributes:
        values: The parameters that select it, by name.
        name: The airframe in words; its numbers if it is not known.
        defined: False if the vehicle has none, and does not fly.
    """

    values: Mapping[str, int]
    name: str
    defined: bool


@dataclass(frozen=True, slots=True)
class AirframeChoices:
    """The airframes that have names; a firmware accepts further numbers.

    Attributes:
        airframes: Names by number: SYS_AUTOSTART of PX4, FRAME_CLASS of ArduPilot.
        types: Names by FRAME_TYPE of ArduPilot; empty for PX4.
    """

    airframes: Mapping[int, str]
    types: Mapping[int, str]


@dataclass(frozen=True, slots=True)
class AirframeChange:
    """The change to another airframe.

    Attributes:
        sets: The parameters that are set, by name.
        resets: True if all other parameters return to the defaults of the airframe.
        keeps: Patterns of the parameters that are not reset; empty without a reset.
        restart: True if it takes effect after a restart.
    """

    sets: Mapping[str, int]
    resets: bool = False
    keeps: tuple[str, ...] = ()
    restart: bool = True

    def __str__(self) -> str:
        sets = ", ".join(f"{name} {value}" for name, value in self.sets.items())
        resets = f"; resets all parameters except {', '.join(self.keeps)}" if self.resets else ""
        return f"sets {sets}{resets}"


async def get_airframe(vehicle: Vehicle) -> Airframe:
    """Read the airframe.

    Args:
        vehicle: The vehicle.

    Returns:
        The airframe.

    Raises:
        ActionUnsupported: The firmware or the vehicle type has no parameter for it.
        RemoteError: The vehicle does not answer.
    """
    names = _parameters_of(vehicle)
    values = {name: int((await vehicle.params.get(name)).value) for name in names}
    return _airframe(values, airframe_choices(vehicle))


def airframe_choices(vehicle: Vehicle) -> AirframeChoices:
    """Return the airframes that a vehicle may have; nothing is sent.

    Args:
        vehicle: The vehicle.

    Returns:
        Their names by number.

    Raises:
        ActionUnsupported: The firmware or the vehicle type has no parameter for it.
    """
    if _parameters_of(vehicle) == (AUTOSTART,):
        return AirframeChoices(PX4_AIRFRAMES, MappingProxyType({}))
    if str(vehicle.vehicle_type) in ("rover", "boat"):
        return AirframeChoices(_ROVER_CLASSES, _ROVER_TYPES)
    return AirframeChoices(COPTER_CLASSES, COPTER_TYPES)


def plan_airframe(
    vehicle: Vehicle, airframe: int, frame_type: int | None = None, *, reset: bool = True
) -> AirframeChange:
    """Return the change to another airframe; nothing is sent.

    Args:
        vehicle: The vehicle.
        airframe: The number of the airframe: SYS_AUTOSTART of PX4, FRAME_CLASS of ArduPilot.
        frame_type: FRAME_TYPE of ArduPilot; None: as it is.
        reset: Let PX4 reset its parameters; ArduPilot never does.

    Returns:
        The change.

    Raises:
        ActionUnsupported: The firmware or the vehicle type has no parameter for it.
        InvalidArgumentError: A number is negative, or PX4 has no frame type.
    """
    names = _parameters_of(vehicle)
    if airframe < 0 or (frame_type is not None and frame_type < 0):
        raise InvalidArgumentError(
            f"an airframe is a number of 0 or more, got {min(airframe, frame_type or 0)}"
        )
    if names == (AUTOSTART,):
        if frame_type is not None:
            raise InvalidArgumentError("PX4 has no frame type: the airframe is one number")
        sets = {AUTOSTART: airframe} | ({AUTOCONFIG: 1} if reset else {})
        return AirframeChange(sets, reset, PX4_KEEPS if reset else ())
    return AirframeChange({FRAME_CLASS: airframe} | ({} if frame_type is None else {FRAME_TYPE: frame_type}))


async def set_airframe(vehicle: Vehicle, change: AirframeChange, *, restart: bool = True) -> Airframe:
    """Change the airframe.

    Args:
        vehicle: The vehicle, disarmed.
        change: The change, from `plan_airframe`.
        restart: Restart the vehicle, so that it takes effect.

    Returns:
        The airframe that the vehicle has afterwards.

    Raises:
        ActionRefused: The vehicle is armed; nothing was sent.
        RemoteError: The vehicle refuses a value or the restart, or does not answer.
    """
    if vehicle.armed:
        raise refusal(vehicle, "changing the airframe of", "it is armed; disarm it first")
    for name, value in change.sets.items():
        await with_status_texts(vehicle, vehicle.params.set(name, value))
    await vehicle.params.commit()
    if restart:
        await vehicle.reboot()
    return await get_airframe(vehicle)


def _parameters_of(vehicle: Vehicle) -> tuple[str, ...]:
    if vehicle.autopilot == common.MavAutopilot.PX4:
        return (AUTOSTART,)
    kind = str(vehicle.vehicle_type)
    if vehicle.autopilot == common.MavAutopilot.ARDUPILOTMEGA and kind in ("copter", "rover", "boat"):
        return FRAME_CLASS, FRAME_TYPE
    raise firmware_of(vehicle).unsupported("select an airframe", "it has no parameter for that")


def _airframe(values: Mapping[str, int], choices: AirframeChoices) -> Airframe:
    if AUTOSTART in values:
        number = values[AUTOSTART]
        return Airframe(values, choices.airframes.get(number, f"airframe {number}"), number != 0)
    number, kind = values[FRAME_CLASS], values[FRAME_TYPE]
    name = f"{choices.airframes.get(number, f'class {number}')}, {choices.types.get(kind, f'type {kind}')}"
    return Airframe(values, name, number != 0)
