"""ArduPilot's modes: their numbers and names by firmware, and which behaviour each is.

All of them are told as not standard, as the firmware does. Modes that need something no simulated vehicle has
(a beacon, optical flow, somebody to follow) are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import ardupilotmega, common
from mavstack.services.modes import AvailableMode
from mavstack.sim.ardupilot.behaviours import (
    LandingSequence,
    PlaneReturn,
    QuadplaneReturn,
    SmartReturn,
    WingTakeoff,
)
from mavstack.sim.autopilot.behaviours import (
    Acro,
    AltitudeHold,
    Brake,
    Circle,
    Guided,
    Land,
    Manual,
    PositionHold,
    ReturnToLaunch,
    Stabilize,
    Stop,
)
from mavstack.sim.autopilot.behaviours.mission import Mission
from mavstack.sim.autopilot.interfaces import Mode
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.interfaces import Autopilot

_COPTER, _PLANE = ardupilotmega.CopterMode, ardupilotmega.PlaneMode
_ROVER, _SUB = ardupilotmega.RoverMode, ardupilotmega.SubMode
_FLAGS = common.MavModeFlag
Maker: TypeAlias = "Callable[[Autopilot], Behaviour]"

_MANUAL: Final = int(_FLAGS.MANUAL_INPUT_ENABLED)
_STABILIZED: Final = int(_FLAGS.STABILIZE_ENABLED) | _MANUAL
_GUIDED: Final = int(_FLAGS.GUIDED_ENABLED) | _STABILIZED
_DRIVEN: Final = int(_FLAGS.GUIDED_ENABLED)


@dataclass(frozen=True, slots=True)
class Roles:
    """The modes of a firmware by what they are for."""

    initial: int
    hold: int
    guided: int
    mission: int
    return_to_launch: int
    land: int
    take_off: int


def _mode(
    number: int,
    name: str,
    behaviour: Maker,
    flags: int,
    *,
    position: bool = False,
    hand: bool = False,
    arm: bool = True,
) -> Mode:
    return Mode(
        AvailableMode(int(number), name),
        behaviour,
        flags=flags,
        needs_position=position,
        manual_control=hand,
        may_arm=arm,
    )


_COPTER_MODES: Final = (
    _mode(_COPTER.STABILIZE, "STABILIZE", Stabilize, _STABILIZED, hand=True),
    _mode(_COPTER.ACRO, "ACRO", Acro, _STABILIZED, hand=True),
    _mode(_COPTER.ALT_HOLD, "ALT_HOLD", AltitudeHold, _STABILIZED, hand=True),
    _mode(_COPTER.AUTO, "AUTO", Mission, _GUIDED, position=True, arm=False),
    _mode(_COPTER.GUIDED, "GUIDED", Guided, _GUIDED, position=True),
    _mode(_COPTER.LOITER, "LOITER", PositionHold, _GUIDED, position=True, hand=True),
    _mode(_COPTER.RTL, "RTL", ReturnToLaunch, _GUIDED, position=True, arm=False),
    _mode(_COPTER.CIRCLE, "CIRCLE", Circle, _GUIDED, position=True, arm=False),
    _mode(_COPTER.LAND, "LAND", Land, _STABILIZED, arm=False),
    _mode(_COPTER.POSHOLD, "POSHOLD", PositionHold, _GUIDED, position=True, hand=True),
    _mode(_COPTER.BRAKE, "BRAKE", Brake, _GUIDED, position=True, arm=False),
    _mode(_COPTER.GUIDED_NOGPS, "GUIDED_NOGPS", Guided, _STABILIZED),
    _mode(_COPTER.SMART_RTL, "SMART_RTL", SmartReturn, _GUIDED, position=True, arm=False),
    _mode(_COPTER.AUTO_RTL, "AUTO_RTL", LandingSequence, _GUIDED, position=True, arm=False),
)
_PLANE_MODES: Final = (
    _mode(_PLANE.MANUAL, "MANUAL", Manual, _STABILIZED, hand=True),
    _mode(_PLANE.CIRCLE, "CIRCLE", partial(Brake, forward=True), _GUIDED),
    _mode(_PLANE.STABILIZE, "STABILIZE", partial(Stabilize, forward=True), _STABILIZED, hand=True),
    _mode(_PLANE.TRAINING, "TRAINING", partial(Stabilize, forward=True), _MANUAL, hand=True),
    _mode(_PLANE.ACRO, "ACRO", partial(Acro, forward=True), _MANUAL, hand=True),
    _mode(_PLANE.FLY_BY_WIRE_A, "FBWA", partial(Stabilize, forward=True), _STABILIZED, hand=True),
    _mode(_PLANE.FLY_BY_WIRE_B, "FBWB", partial(AltitudeHold, forward=True), _STABILIZED, hand=True),
    _mode(_PLANE.CRUISE, "CRUISE", partial(AltitudeHold, forward=True), _STABILIZED, hand=True),
    _mode(_PLANE.AUTO, "AUTO", Mission, _GUIDED),
    _mode(_PLANE.RTL, "RTL", PlaneReturn, _GUIDED),
    _mode(_PLANE.LOITER, "LOITER", partial(Brake, forward=True), _GUIDED),
    _mode(_PLANE.TAKEOFF, "TAKEOFF", WingTakeoff, _GUIDED),
    _mode(_PLANE.GUIDED, "GUIDED", Guided, _GUIDED),
)
_HOVERING_MODES: Final = (
    _mode(_PLANE.QSTABILIZE, "QSTABILIZE", partial(Stabilize, forward=False), _STABILIZED, hand=True),
    _mode(_PLANE.QHOVER, "QHOVER", partial(AltitudeHold, forward=False), _STABILIZED, hand=True),
    _mode(
        _PLANE.QLOITER, "QLOITER", partial(PositionHold, forward=False), _STABILIZED, position=True, hand=True
    ),
    _mode(_PLANE.QLAND, "QLAND", Land, _STABILIZED, arm=False),
    _mode(_PLANE.QRTL, "QRTL", QuadplaneReturn, _GUIDED, position=True, arm=False),
)
_ROVER_MODES: Final = (
    _mode(_ROVER.MANUAL, "MANUAL", Manual, _MANUAL, hand=True),
    _mode(_ROVER.ACRO, "ACRO", Acro, _MANUAL, hand=True),
    _mode(_ROVER.STEERING, "STEERING", AltitudeHold, _MANUAL, hand=True),
    _mode(_ROVER.HOLD, "HOLD", Stop, 0),
    _mode(_ROVER.LOITER, "LOITER", Brake, _DRIVEN, position=True),
    _mode(_ROVER.CIRCLE, "CIRCLE", Circle, _DRIVEN, position=True),
    _mode(_ROVER.AUTO, "AUTO", Mission, _DRIVEN, position=True),
    _mode(_ROVER.RTL, "RTL", ReturnToLaunch, _DRIVEN, position=True, arm=False),
    _mode(_ROVER.SMART_RTL, "SMART_RTL", SmartReturn, _DRIVEN, position=True, arm=False),
    _mode(_ROVER.GUIDED, "GUIDED", Guided, _DRIVEN, position=True),
)
_SUB_MODES: Final = (
    _mode(_SUB.STABILIZE, "STABILIZE", Stabilize, _STABILIZED, hand=True),
    _mode(_SUB.ACRO, "ACRO", Acro, _STABILIZED, hand=True),
    _mode(_SUB.ALT_HOLD, "ALT_HOLD", AltitudeHold, _STABILIZED, hand=True),
    _mode(_SUB.AUTO, "AUTO", Mission, _GUIDED, position=True),
    _mode(_SUB.GUIDED, "GUIDED", Guided, _GUIDED, position=True),
    _mode(_SUB.CIRCLE, "CIRCLE", Circle, _GUIDED, position=True),
    _mode(_SUB.SURFACE, "SURFACE", Land, _STABILIZED),
    _mode(_SUB.POSHOLD, "POSHOLD", PositionHold, _GUIDED, position=True, hand=True),
    _mode(_SUB.MANUAL, "MANUAL", Manual, _STABILIZED, hand=True),
)

MODES: Final[Mapping[VehicleType, tuple[Mode, ...]]] = MappingProxyType(
    {
        VehicleType.COPTER: _COPTER_MODES,
        VehicleType.PLANE: _PLANE_MODES,
        VehicleType.VTOL: (*_PLANE_MODES, *_HOVERING_MODES),
        VehicleType.ROVER: _ROVER_MODES,
        VehicleType.BOAT: _ROVER_MODES,
        VehicleType.SUB: _SUB_MODES,
    }
)


def _roles(*modes: int) -> Roles:
    return Roles(*(int(mode) for mode in modes))


_ROVER_ROLES: Final = _roles(
    _ROVER.MANUAL, _ROVER.HOLD, _ROVER.GUIDED, _ROVER.AUTO, _ROVER.RTL, _ROVER.HOLD, _ROVER.GUIDED
)
ROLES: Final[Mapping[VehicleType, Roles]] = MappingProxyType(
    {
        VehicleType.COPTER: _roles(
            _COPTER.STABILIZE,
            _COPTER.LOITER,
            _COPTER.GUIDED,
            _COPTER.AUTO,
            _COPTER.RTL,
            _COPTER.LAND,
            _COPTER.GUIDED,
        ),
        VehicleType.PLANE: _roles(
            _PLANE.MANUAL, _PLANE.LOITER, _PLANE.GUIDED, _PLANE.AUTO, _PLANE.RTL, _PLANE.RTL, _PLANE.TAKEOFF
        ),
        VehicleType.VTOL: _roles(
            _PLANE.FLY_BY_WIRE_A,
            _PLANE.LOITER,
            _PLANE.GUIDED,
            _PLANE.AUTO,
            _PLANE.RTL,
            _PLANE.QLAND,
            _PLANE.GUIDED,
        ),
        VehicleType.ROVER: _ROVER_ROLES,
        VehicleType.BOAT: _ROVER_ROLES,
        VehicleType.SUB: _roles(
            _SUB.MANUAL, _SUB.POSHOLD, _SUB.GUIDED, _SUB.AUTO, _SUB.SURFACE, _SUB.SURFACE, _SUB.GUIDED
        ),
    }
)
#: The bits of FLTMODE_GCSBLOCK, in order: modes that ground stations may be kept from.
BLOCKABLE: Final[Mapping[VehicleType, tuple[int, ...]]] = MappingProxyType(
    {
        VehicleType.COPTER: (0, 1, 2, 3, 4, 5, 7, 11, *range(13, 29)),
    }
)
