"""ArduPilot's modes: numbers and names by firmware, and their behaviours.

All modes are reported as non-standard, as the firmware does. Modes that need equipment which no simulated
vehicle has (a beacon, optical flow) are left out.
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
    PlaneTakeoff,
    QuadplaneReturn,
    SmartReturn,
)
from mavstack.sim.ardupilot.follow import Follow
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
from mavstack.sim.autopilot.firmware_profile import Mode
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.behaviour import Behaviour

_COPTER, _PLANE = ardupilotmega.CopterMode, ardupilotmega.PlaneMode
_ROVER, _SUB = ardupilotmega.RoverMode, ardupilotmega.SubMode
_FLAGS = common.MavModeFlag
BehaviourFactory: TypeAlias = "Callable[[SimulatedAutopilot], Behaviour]"

_MANUAL: Final = int(_FLAGS.MANUAL_INPUT_ENABLED)
_STABILIZED: Final = int(_FLAGS.STABILIZE_ENABLED) | _MANUAL
_GUIDED: Final = int(_FLAGS.GUIDED_ENABLED) | _STABILIZED
_AUTOMATIC_DRIVING: Final = int(_FLAGS.GUIDED_ENABLED)


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeRoles:
    """The modes of a firmware by purpose."""

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
    behaviour: BehaviourFactory,
    flags: int,
    *,
    needs_position: bool = False,
    manual_control: bool = False,
    may_arm: bool = True,
) -> Mode:
    """Return a mode."""
    return Mode(
        AvailableMode(int(number), name),
        behaviour,
        flags=flags,
        needs_position=needs_position,
        manual_control=manual_control,
        may_arm=may_arm,
    )


_COPTER_MODES: Final = (
    _mode(_COPTER.STABILIZE, "STABILIZE", Stabilize, _STABILIZED, manual_control=True),
    _mode(_COPTER.ACRO, "ACRO", Acro, _STABILIZED, manual_control=True),
    _mode(_COPTER.ALT_HOLD, "ALT_HOLD", AltitudeHold, _STABILIZED, manual_control=True),
    _mode(_COPTER.AUTO, "AUTO", Mission, _GUIDED, needs_position=True, may_arm=False),
    _mode(_COPTER.GUIDED, "GUIDED", Guided, _GUIDED, needs_position=True),
    _mode(_COPTER.LOITER, "LOITER", PositionHold, _GUIDED, needs_position=True, manual_control=True),
    _mode(_COPTER.RTL, "RTL", ReturnToLaunch, _GUIDED, needs_position=True, may_arm=False),
    _mode(_COPTER.CIRCLE, "CIRCLE", Circle, _GUIDED, needs_position=True, may_arm=False),
    _mode(_COPTER.LAND, "LAND", Land, _STABILIZED, may_arm=False),
    _mode(_COPTER.POSHOLD, "POSHOLD", PositionHold, _GUIDED, needs_position=True, manual_control=True),
    _mode(_COPTER.BRAKE, "BRAKE", Brake, _GUIDED, needs_position=True, may_arm=False),
    _mode(_COPTER.AVOID_ADSB, "AVOID_ADSB", Guided, _GUIDED, needs_position=True, may_arm=False),
    _mode(_COPTER.GUIDED_NOGPS, "GUIDED_NOGPS", Guided, _STABILIZED),
    _mode(_COPTER.SMART_RTL, "SMART_RTL", SmartReturn, _GUIDED, needs_position=True, may_arm=False),
    _mode(_COPTER.FOLLOW, "FOLLOW", Follow, _GUIDED, needs_position=True, may_arm=False),
    _mode(_COPTER.AUTO_RTL, "AUTO_RTL", LandingSequence, _GUIDED, needs_position=True, may_arm=False),
)
_PLANE_MODES: Final = (
    _mode(_PLANE.MANUAL, "MANUAL", Manual, _STABILIZED, manual_control=True),
    _mode(_PLANE.CIRCLE, "CIRCLE", partial(Brake, forward=True), _GUIDED),
    _mode(_PLANE.STABILIZE, "STABILIZE", partial(Stabilize, forward=True), _STABILIZED, manual_control=True),
    _mode(_PLANE.TRAINING, "TRAINING", partial(Stabilize, forward=True), _MANUAL, manual_control=True),
    _mode(_PLANE.ACRO, "ACRO", partial(Acro, forward=True), _MANUAL, manual_control=True),
    _mode(_PLANE.FLY_BY_WIRE_A, "FBWA", partial(Stabilize, forward=True), _STABILIZED, manual_control=True),
    _mode(
        _PLANE.FLY_BY_WIRE_B, "FBWB", partial(AltitudeHold, forward=True), _STABILIZED, manual_control=True
    ),
    _mode(_PLANE.CRUISE, "CRUISE", partial(AltitudeHold, forward=True), _STABILIZED, manual_control=True),
    _mode(_PLANE.AUTO, "AUTO", Mission, _GUIDED),
    _mode(_PLANE.RTL, "RTL", PlaneReturn, _GUIDED, may_arm=False),
    _mode(_PLANE.LOITER, "LOITER", partial(Brake, forward=True), _GUIDED),
    _mode(_PLANE.TAKEOFF, "TAKEOFF", PlaneTakeoff, _GUIDED),
    _mode(_PLANE.GUIDED, "GUIDED", Guided, _GUIDED),
    _mode(_PLANE.AVOID_ADSB, "AVOID_ADSB", Guided, _GUIDED),
)
_HOVERING_MODES: Final = (
    _mode(
        _PLANE.QSTABILIZE, "QSTABILIZE", partial(Stabilize, forward=False), _STABILIZED, manual_control=True
    ),
    _mode(_PLANE.QHOVER, "QHOVER", partial(AltitudeHold, forward=False), _STABILIZED, manual_control=True),
    _mode(
        _PLANE.QLOITER,
        "QLOITER",
        partial(PositionHold, forward=False),
        _STABILIZED,
        needs_position=True,
        manual_control=True,
    ),
    _mode(_PLANE.QLAND, "QLAND", Land, _STABILIZED, may_arm=False),
    _mode(_PLANE.QRTL, "QRTL", QuadplaneReturn, _GUIDED, needs_position=True, may_arm=False),
)
_ROVER_MODES: Final = (
    _mode(_ROVER.MANUAL, "MANUAL", Manual, _MANUAL, manual_control=True),
    _mode(_ROVER.ACRO, "ACRO", Acro, _MANUAL, manual_control=True),
    _mode(_ROVER.STEERING, "STEERING", AltitudeHold, _MANUAL, manual_control=True),
    _mode(_ROVER.HOLD, "HOLD", Stop, 0),
    _mode(_ROVER.LOITER, "LOITER", Brake, _AUTOMATIC_DRIVING, needs_position=True),
    _mode(_ROVER.FOLLOW, "FOLLOW", Follow, _AUTOMATIC_DRIVING, needs_position=True),
    _mode(_ROVER.CIRCLE, "CIRCLE", Circle, _AUTOMATIC_DRIVING, needs_position=True),
    _mode(_ROVER.AUTO, "AUTO", Mission, _AUTOMATIC_DRIVING, needs_position=True),
    _mode(_ROVER.RTL, "RTL", ReturnToLaunch, _AUTOMATIC_DRIVING, needs_position=True, may_arm=False),
    _mode(_ROVER.SMART_RTL, "SMART_RTL", SmartReturn, _AUTOMATIC_DRIVING, needs_position=True, may_arm=False),
    _mode(_ROVER.GUIDED, "GUIDED", Guided, _AUTOMATIC_DRIVING, needs_position=True),
)
_SUB_MODES: Final = (
    _mode(_SUB.STABILIZE, "STABILIZE", Stabilize, _STABILIZED, manual_control=True),
    _mode(_SUB.ACRO, "ACRO", Acro, _STABILIZED, manual_control=True),
    _mode(_SUB.ALT_HOLD, "ALT_HOLD", AltitudeHold, _STABILIZED, manual_control=True),
    _mode(_SUB.AUTO, "AUTO", Mission, _GUIDED, needs_position=True),
    _mode(_SUB.GUIDED, "GUIDED", Guided, _GUIDED, needs_position=True),
    _mode(_SUB.CIRCLE, "CIRCLE", Circle, _GUIDED, needs_position=True),
    _mode(_SUB.SURFACE, "SURFACE", Land, _STABILIZED),
    _mode(_SUB.POSHOLD, "POSHOLD", PositionHold, _GUIDED, needs_position=True, manual_control=True),
    _mode(_SUB.MANUAL, "MANUAL", Manual, _STABILIZED, manual_control=True),
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


_ROVER_ROLES: Final = ModeRoles(
    initial=_ROVER.MANUAL,
    hold=_ROVER.HOLD,
    guided=_ROVER.GUIDED,
    mission=_ROVER.AUTO,
    return_to_launch=_ROVER.RTL,
    land=_ROVER.HOLD,
    take_off=_ROVER.GUIDED,
)
MODE_ROLES: Final[Mapping[VehicleType, ModeRoles]] = MappingProxyType(
    {
        VehicleType.COPTER: ModeRoles(
            initial=_COPTER.STABILIZE,
            hold=_COPTER.LOITER,
            guided=_COPTER.GUIDED,
            mission=_COPTER.AUTO,
            return_to_launch=_COPTER.RTL,
            land=_COPTER.LAND,
            take_off=_COPTER.GUIDED,
        ),
        VehicleType.PLANE: ModeRoles(
            initial=_PLANE.MANUAL,
            hold=_PLANE.LOITER,
            guided=_PLANE.GUIDED,
            mission=_PLANE.AUTO,
            return_to_launch=_PLANE.RTL,
            land=_PLANE.RTL,
            take_off=_PLANE.TAKEOFF,
        ),
        VehicleType.VTOL: ModeRoles(
            initial=_PLANE.FLY_BY_WIRE_A,
            hold=_PLANE.LOITER,
            guided=_PLANE.GUIDED,
            mission=_PLANE.AUTO,
            return_to_launch=_PLANE.RTL,
            land=_PLANE.QLAND,
            take_off=_PLANE.GUIDED,
        ),
        VehicleType.ROVER: _ROVER_ROLES,
        VehicleType.BOAT: _ROVER_ROLES,
        VehicleType.SUB: ModeRoles(
            initial=_SUB.MANUAL,
            hold=_SUB.POSHOLD,
            guided=_SUB.GUIDED,
            mission=_SUB.AUTO,
            return_to_launch=_SUB.SURFACE,
            land=_SUB.SURFACE,
            take_off=_SUB.GUIDED,
        ),
    }
)
#: Modes in the order of the bits of FLTMODE_GCSBLOCK, which forbids ground stations to enter them.
BLOCKABLE: Final[Mapping[VehicleType, tuple[int, ...]]] = MappingProxyType(
    {VehicleType.COPTER: (0, 1, 2, 3, 4, 5, 7, 11, *range(13, 29))}
)
