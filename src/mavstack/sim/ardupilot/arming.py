"""Arming checks of ArduPilot and their status texts.

ARMING_CHECK enables the checks by bits, where bit 0 enables all; the requirements of the mode are always
checked. Copter checks the mode only when it is armed, so that its pre-arm bit says in RTL that it is ready;
Plane and Rover check it before. The problems are sent with "PreArm:" every 30 s while the vehicle is
disarmed, and with "Arm:" when arming is refused.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.sim.ardupilot.external_vision import vision_problems
from mavstack.sim.ardupilot.terrain import terrain_problems
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.parameters import Parameters

Check: TypeAlias = "Callable[[SimulatedAutopilot], Iterator[str]]"

#: Bit numbers of ARMING_CHECK.
_ALL, _BAROMETER, _COMPASS, _GPS, _PARAMETERS, _RC, _BATTERY, _MISSION = 0, 1, 2, 3, 5, 6, 8, 14
_VISION: Final = 18
#: Interval in seconds at which pre-arm problems are reported.
DISPLAY_INTERVAL = 30.0
_QUIET_OPTION = 1
_FIX_3D = int(common.GpsFixType["_3D_FIX"])
_MIN_SATELLITES = 6
_THROTTLE_LOW = 0.03
_THROTTLE_NEUTRAL = 0.55
_FENCES_WITH_POSITION = 0b110
_WITHOUT_MODULE: Final = "ARM_STATUS not available"
#: Items that ARMING_MIS_ITEMS can require, in the order of its bits: the command, and its name in pre-arm
#: reports.
_REQUIRED_ITEMS: Final = (
    (common.MavCmd.NAV_LAND, "land"),
    (common.MavCmd.NAV_VTOL_LAND, "vtol land"),
    (common.MavCmd.DO_LAND_START, "do_land_start"),
    (common.MavCmd.NAV_TAKEOFF, "takeoff"),
    (common.MavCmd.NAV_VTOL_TAKEOFF, "vtol takeoff"),
)


def prearm_problems(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Yield problems of the vehicle that do not depend on the pilot, without a prefix."""
    if not autopilot.booted:
        yield "System not initialised"
        return
    yield from _problems_of(autopilot, _CHECKS)


def arming_problems(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Yield everything that prevents arming now: without pre-arm problems, the mode and the throttle."""
    ready = True
    for problem in prearm_problems(autopilot):
        ready = False
        yield problem
    if ready:
        yield from _problems_of(autopilot, _ARM_CHECKS)


def _problems_of(
    autopilot: SimulatedAutopilot, checks: tuple[tuple[int | None, Check], ...]
) -> Iterator[str]:
    """Yield the problems of the enabled checks."""
    enabled = int(_number(autopilot.vehicle.parameters, "ARMING_CHECK"))
    for bit, check in checks:
        if bit is None or enabled & 1 or enabled >> bit & 1:
            yield from check(autopilot)


def _position(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the requirements of the mode, regardless of ARMING_CHECK."""
    if not autopilot.body.health.attitude:
        yield "EKF attitude is bad"
    fenced = int(_number(autopilot.vehicle.parameters, "FENCE_ENABLE")) and (
        int(_number(autopilot.vehicle.parameters, "FENCE_TYPE")) & _FENCES_WITH_POSITION
    )
    if autopilot.has_position:
        return
    if autopilot.mode.needs_position:
        yield "Need Position Estimate"
    elif fenced:
        yield "Fence enabled, need position estimate"


def _may_arm(autopilot: SimulatedAutopilot) -> bool:
    """Return whether the mode allows arming."""
    mode, parameters = autopilot.mode, autopilot.vehicle.parameters
    return mode.may_arm or (mode.name == "AUTO" and bool(int(_number(parameters, "AUTO_OPTIONS")) & 1))


def _mode(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check that the mode allows arming; Copter does so when it is armed."""
    if autopilot.vehicle.vehicle_type is VehicleType.COPTER and not _may_arm(autopilot):
        yield f"{autopilot.mode.name} mode not armable"


def _mode_before_arming(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check that the mode allows arming; Plane and Rover do so with the pre-arm checks."""
    kind = autopilot.vehicle.vehicle_type
    if kind is VehicleType.COPTER or _may_arm(autopilot):
        return
    yield "Mode not armable" if kind.on_surface else f"{autopilot.mode.name} mode not armable"


def _gps(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the GPS fix."""
    if not _uses_gps(autopilot):
        return
    sensors, parameters = autopilot.body.sensors, autopilot.vehicle.parameters
    if sensors.gps_fix < _FIX_3D or sensors.gps_satellites < _MIN_SATELLITES:
        yield "GPS 1: Bad fix"
    elif autopilot.vehicle.vehicle_type is VehicleType.COPTER:
        if sensors.gps_eph * 100 > _number(parameters, "GPS_HDOP_GOOD", 140.0):
            yield "High GPS HDOP"
    elif autopilot.home is None:
        yield "AHRS: waiting for home"


def _uses_gps(autopilot: SimulatedAutopilot) -> bool:
    """Return whether GPS is required: always on Plane and Rover, by the mode on Copter and Sub.

    A vehicle whose receiver is switched off (GPS1_TYPE 0) flies by other means.
    """
    if not int(_number(autopilot.vehicle.parameters, "GPS1_TYPE", 1)):
        return False
    if autopilot.vehicle.vehicle_type in (VehicleType.COPTER, VehicleType.SUB):
        return autopilot.mode.needs_position
    return True


def _variances(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the test ratios of Copter's filter."""
    limit = _number(autopilot.vehicle.parameters, "FS_EKF_THRESH")
    if (
        limit <= 0
        or autopilot.vehicle.vehicle_type is not VehicleType.COPTER
        or not autopilot.mode.needs_position
    ):
        return
    health = autopilot.body.health
    named = (
        ("compass", health.compass_variance),
        ("position", health.position_variance),
        ("velocity", health.velocity_variance),
        ("height", health.height_variance),
    )
    yield from (f"EKF {name} variance" for name, variance in named if variance >= limit)


def _barometer(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the barometer."""
    if not autopilot.body.health.vertical:
        yield "Barometer not healthy"


def _compass(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the compass."""
    enabled = int(_number(autopilot.vehicle.parameters, "COMPASS_ENABLE", 1.0))
    if enabled and not autopilot.body.health.heading:
        yield "Compass 1 not healthy"


def _radio(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the radio receiver."""
    radio, parameters = autopilot.radio, autopilot.vehicle.parameters
    if autopilot.vehicle.vehicle_type is VehicleType.SUB:
        return
    if not radio.present:
        watched = _number(parameters, "FS_THR_ENABLE", 0.0) or _number(parameters, "THR_FAILSAFE", 0.0)
        if watched:
            copter = autopilot.vehicle.vehicle_type is VehicleType.COPTER
            yield "Throttle below failsafe" if copter else "Radio failsafe on"


def _throttle(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check that the throttle is closed."""
    if not autopilot.radio.present or autopilot.vehicle.vehicle_type is VehicleType.SUB:
        return
    if autopilot.mode.manual_control and _is_throttle_open(autopilot):
        copter = autopilot.vehicle.vehicle_type is VehicleType.COPTER
        yield "Throttle too high" if copter else "Throttle (RC3) is not neutral"


def _is_throttle_open(autopilot: SimulatedAutopilot) -> bool:
    """Return whether the throttle is too far from idle or neutral."""
    throttle = autopilot.radio.sticks.throttle
    if autopilot.vehicle.vehicle_type.on_surface:
        return not 1 - _THROTTLE_NEUTRAL <= throttle <= _THROTTLE_NEUTRAL
    return throttle > _THROTTLE_LOW


def _battery(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check voltage and capacity."""
    battery, parameters = autopilot.body.battery, autopilot.vehicle.parameters
    left = _number(parameters, "BATT_CAPACITY") - battery.consumed
    limits = (
        ("BATT_CRT_VOLT", battery.voltage, "Battery 1 critical voltage failsafe"),
        ("BATT_LOW_VOLT", battery.voltage, "Battery 1 low voltage failsafe"),
        ("BATT_CRT_MAH", left, "Battery 1 critical capacity failsafe"),
        ("BATT_LOW_MAH", left, "Battery 1 low capacity failsafe"),
        ("BATT_ARM_VOLT", battery.voltage, "Battery 1 below minimum arming voltage"),
        ("BATT_ARM_MAH", left, "Battery 1 below minimum arming capacity"),
    )
    if int(_number(parameters, "BATT_MONITOR", 1.0)):
        yield from (text for name, value, text in limits if 0 < value < _number(parameters, name))


def _fence(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the geofence."""
    yield from autopilot.fence.problems()


def _remote_id(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the Remote ID module, if DID_ENABLE and the first bit of DID_OPTIONS require one."""
    vehicle = autopilot.vehicle
    if int(_number(vehicle.parameters, "DID_ENABLE")) and int(_number(vehicle.parameters, "DID_OPTIONS")) & 1:
        module = vehicle.remote_id
        problem = _WITHOUT_MODULE if module is None else module.ardupilot_problem
        if problem:
            yield f"OpenDroneID: {problem}"


def _mission(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the items that ARMING_MIS_ITEMS requires."""
    required = int(_number(autopilot.vehicle.parameters, "ARMING_MIS_ITEMS"))
    if not required:
        return
    present = {int(item.command) for item in autopilot.vehicle.mission.plan(0).items}
    for bit, (command, name) in enumerate(_REQUIRED_ITEMS):
        if required >> bit & 1 and command not in present:
            yield f"Missing mission item: {name}"


_CHECKS: Final[tuple[tuple[int | None, Check], ...]] = (
    (_BAROMETER, _barometer),
    (_COMPASS, _compass),
    (_GPS, _gps),
    (None, _position),
    (_GPS, _variances),
    (_BATTERY, _battery),
    (_RC, _radio),
    (_MISSION, _mission),
    (_PARAMETERS, terrain_problems),
    (_VISION, vision_problems),
    (None, _fence),
    (None, _remote_id),
    (None, _mode_before_arming),
)
_ARM_CHECKS: Final[tuple[tuple[int | None, Check], ...]] = ((None, _mode), (_RC, _throttle))


class PreArmReporter:
    """Reports the pre-arm problems every 30 s."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self._due = autopilot.booted_at + DISPLAY_INTERVAL

    def tick(self, now: float) -> None:
        """Report if due."""
        autopilot = self._autopilot
        if autopilot.armed or now < self._due:
            return
        self._due = now + DISPLAY_INTERVAL
        if int(_number(autopilot.vehicle.parameters, "ARMING_OPTIONS")) & _QUIET_OPTION:
            return
        for problem in prearm_problems(autopilot):
            autopilot.vehicle.send_statustext(f"PreArm: {problem}", common.MavSeverity.CRITICAL)


def _number(parameters: Parameters, name: str, default: float = 0.0) -> float:
    """Return a parameter as a number."""
    value = float(parameters.get(name, default))
    return value if abs(value) < 1e9 else default
