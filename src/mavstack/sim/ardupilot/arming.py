"""Whether an ArduPilot may be armed, and what it says if not.

ARMING_CHECK switches the checks on by bits, bit 0 being all of them; what the mode needs is checked always.
The same reasons come with "PreArm:" every half minute while the vehicle is disarmed, and with "Arm:" when
somebody tries to arm it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.parameters import Parameters

Check: TypeAlias = "Callable[[Autopilot], Iterator[str]]"

#: Bits of ARMING_CHECK.
_ALL, _BAROMETER, _COMPASS, _GPS, _RC, _BATTERY, _MISSION = 0, 1, 2, 3, 6, 8, 14
#: How often the reasons are said again, in seconds.
DISPLAY_PERIOD = 30.0
_QUIET_OPTION = 1
_FIX_3D = int(common.GpsFixType["_3D_FIX"])
_LEAST_SATELLITES = 6
_THROTTLE_LOW = 0.03
_THROTTLE_MIDDLE = 0.55
_FENCES_WITH_POSITION = 0b110
#: Bits of ARMING_MIS_ITEMS.
_REQUIRED_ITEMS: Final = (
    (common.MavCmd.NAV_LAND, "land"),
    (common.MavCmd.NAV_VTOL_LAND, "vtol land"),
    (common.MavCmd.DO_LAND_START, "do_land_start"),
    (common.MavCmd.NAV_TAKEOFF, "takeoff"),
    (common.MavCmd.NAV_VTOL_TAKEOFF, "vtol takeoff"),
)


def prearm_problems(autopilot: Autopilot) -> Iterator[str]:
    """What is wrong with the vehicle, whatever the pilot wants; without a prefix."""
    if not autopilot.booted:
        yield "System not initialised"
        return
    yield from _failed(autopilot, _CHECKS)


def arming_problems(autopilot: Autopilot) -> Iterator[str]:
    """Everything that keeps it from being armed now: with all that in order, the mode and the throttle."""
    passed = True
    for problem in prearm_problems(autopilot):
        passed = False
        yield problem
    if passed:
        yield from _failed(autopilot, _ARM_CHECKS)


def _failed(autopilot: Autopilot, checks: tuple[tuple[int | None, Check], ...]) -> Iterator[str]:
    enabled = int(_number(autopilot.vehicle.parameters, "ARMING_CHECK"))
    for bit, check in checks:
        if bit is None or enabled & 1 or enabled >> bit & 1:
            yield from check(autopilot)


def _position(autopilot: Autopilot) -> Iterator[str]:
    """What the mode needs, whatever ARMING_CHECK says."""
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


def _mode(autopilot: Autopilot) -> Iterator[str]:
    mode, parameters = autopilot.mode, autopilot.vehicle.parameters
    if mode.may_arm or (mode.name == "AUTO" and int(_number(parameters, "AUTO_OPTIONS")) & 1):
        return
    yield f"{mode.name} mode not armable"


def _gps(autopilot: Autopilot) -> Iterator[str]:
    if not _uses_gps(autopilot):
        return
    sensors, parameters = autopilot.body.sensors, autopilot.vehicle.parameters
    if sensors.gps_fix < _FIX_3D or sensors.gps_satellites < _LEAST_SATELLITES:
        yield "GPS 1: Bad fix"
    elif autopilot.vehicle.type is VehicleType.COPTER:
        if sensors.gps_eph * 100 > _number(parameters, "GPS_HDOP_GOOD", 140.0):
            yield "High GPS HDOP"
    elif autopilot.home is None:
        yield "AHRS: waiting for home"


def _uses_gps(autopilot: Autopilot) -> bool:
    """Plane and Rover always do; Copter and Sub if the mode does."""
    if autopilot.vehicle.type in (VehicleType.COPTER, VehicleType.SUB):
        return autopilot.mode.needs_position
    return True


def _variances(autopilot: Autopilot) -> Iterator[str]:
    """Copters look at what the filter makes of its sensors."""
    limit = _number(autopilot.vehicle.parameters, "FS_EKF_THRESH")
    if limit <= 0 or autopilot.vehicle.type is not VehicleType.COPTER or not autopilot.mode.needs_position:
        return
    health = autopilot.body.health
    named = (
        ("compass", health.compass_variance),
        ("position", health.position_variance),
        ("velocity", health.velocity_variance),
        ("height", health.height_variance),
    )
    yield from (f"EKF {name} variance" for name, variance in named if variance >= limit)


def _barometer(autopilot: Autopilot) -> Iterator[str]:
    if not autopilot.body.health.vertical:
        yield "Barometer not healthy"


def _compass(autopilot: Autopilot) -> Iterator[str]:
    enabled = int(_number(autopilot.vehicle.parameters, "COMPASS_ENABLE", 1.0))
    if enabled and not autopilot.body.health.heading:
        yield "Compass 1 not healthy"


def _radio(autopilot: Autopilot) -> Iterator[str]:
    radio, parameters = autopilot.radio, autopilot.vehicle.parameters
    if autopilot.vehicle.type is VehicleType.SUB:
        return
    if not radio.present:
        watched = _number(parameters, "FS_THR_ENABLE", 0.0) or _number(parameters, "THR_FAILSAFE", 0.0)
        if watched:
            copter = autopilot.vehicle.type is VehicleType.COPTER
            yield "Throttle below failsafe" if copter else "Radio failsafe on"


def _throttle(autopilot: Autopilot) -> Iterator[str]:
    if not autopilot.radio.present or autopilot.vehicle.type is VehicleType.SUB:
        return
    if autopilot.mode.manual_control and _throttle_is_open(autopilot):
        copter = autopilot.vehicle.type is VehicleType.COPTER
        yield "Throttle too high" if copter else "Throttle (RC3) is not neutral"


def _throttle_is_open(autopilot: Autopilot) -> bool:
    throttle = autopilot.radio.sticks.throttle
    if autopilot.vehicle.type.on_surface:
        return not 1 - _THROTTLE_MIDDLE <= throttle <= _THROTTLE_MIDDLE
    return throttle > _THROTTLE_LOW


def _battery(autopilot: Autopilot) -> Iterator[str]:
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


def _fence(autopilot: Autopilot) -> Iterator[str]:
    yield from autopilot.fence.problems()


def _mission(autopilot: Autopilot) -> Iterator[str]:
    wanted = int(_number(autopilot.vehicle.parameters, "ARMING_MIS_ITEMS"))
    if not wanted:
        return
    held = {int(item.command) for item in autopilot.vehicle.mission.plan(0).items}
    for bit, (command, name) in enumerate(_REQUIRED_ITEMS):
        if wanted >> bit & 1 and command not in held:
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
    (None, _fence),
)
_ARM_CHECKS: Final[tuple[tuple[int | None, Check], ...]] = ((None, _mode), (_RC, _throttle))


class PreArmWatch:
    """Says every half minute why the vehicle could not be armed."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self._due = autopilot.booted_at + DISPLAY_PERIOD

    def tick(self, now: float) -> None:
        """Look, and say."""
        autopilot = self._autopilot
        if autopilot.armed or now < self._due:
            return
        self._due = now + DISPLAY_PERIOD
        if int(_number(autopilot.vehicle.parameters, "ARMING_OPTIONS")) & _QUIET_OPTION:
            return
        for problem in prearm_problems(autopilot):
            autopilot.vehicle.send_statustext(f"PreArm: {problem}", common.MavSeverity.CRITICAL)


def _number(parameters: Parameters, name: str, default: float = 0.0) -> float:
    value = float(parameters.get(name, default))
    return value if abs(value) < 1e9 else default
