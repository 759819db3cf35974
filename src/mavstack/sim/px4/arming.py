"""Arming of PX4: preflight checks and their texts, arming and disarming, and the land detector.

PX4 reports most problems twice: as events, and as STATUSTEXT that starts with "Preflight Fail:". Here all of
them are status texts, and only refusals are events too (`events.py`). They are sent when they arise while the
vehicle is disarmed, on RUN_PREARM_CHECKS, and when arming is denied.

After a flight the motors stop COM_DISARM_LAND seconds after landing, in any mode; a vehicle that was armed
and does not take off is disarmed after COM_DISARM_PRFLT seconds, plus the time that its motors take to spin
up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.sim.px4.modes import MISSION, OFFBOARD, RETURN
from mavstack.sim.px4.state import BY_INACTION, BY_LANDING
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.px4.state import Px4State
    from mavstack.sim.vehicle import SimulatedVehicle

Check: TypeAlias = "Callable[[SimulatedAutopilot], Iterator[str]]"

DISARMING_DENIED: Final = "Disarming denied: not landed"
_CRITICAL = common.MavSeverity.CRITICAL
ARMING_DENIED: Final = "Arming denied: Resolve system health failures first"
_FIX_3D: Final = 3  # the value of GPS_FIX_TYPE_3D_FIX
_GATE: Final = 1.0
_IN_AIRPLANE_MODE: Final = 0.5
#: Value of COM_ARM_ODID: arming is denied without a Remote ID.
_DENY_WITHOUT_ID = 2
#: Value of COM_ARM_WO_GPS: arming is denied without GPS.
_DENY = 0


def preflight_problems(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Yield all problems that prevent arming in the present mode."""
    if not autopilot.booted:
        yield "Preflight Fail: ekf2 missing data"
        return
    for check in _CHECKS:
        yield from check(autopilot)


def _system(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check termination, VTOL state and configuration."""
    if autopilot.terminated:
        yield "Preflight Fail: Flight termination active"
    parameters = autopilot.vehicle.parameters
    on_wing = (
        autopilot.vehicle.vehicle_type is VehicleType.VTOL and autopilot.body.transition > _IN_AIRPLANE_MODE
    )
    if on_wing and not int(parameters["CBRK_VTOLARMING"]):
        yield "Preflight Fail: Vehicle is not in multicopter mode"
    if not int(parameters["COM_ARMABLE"]):
        yield "Preflight Fail: Vehicle is in safety configuration"


def _estimate(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the health of the estimate."""
    health = autopilot.body.health
    if not health.attitude:
        yield "Preflight Fail: ekf2 missing data"
    if not health.heading:
        yield "Preflight Fail: heading estimate invalid"
    if not health.vertical or health.height_variance > _GATE:
        yield "Preflight Fail: height estimate not stable"
    if health.horizontal and health.position_variance > _GATE:
        yield "Preflight Fail: horizontal position unstable"
    if health.horizontal and health.velocity_variance > _GATE:
        yield "Preflight Fail: horizontal velocity unstable"


def _compass(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the compass."""
    if int(autopilot.vehicle.parameters["SYS_HAS_MAG"]) and autopilot.body.health.compass_variance > _GATE:
        yield "Preflight Fail: Compass 0 fault"


def _gps(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check GPS and home, if COM_ARM_WO_GPS requires them."""
    parameters = autopilot.vehicle.parameters
    if int(parameters["SYS_HAS_GPS"]) and int(parameters["COM_ARM_WO_GPS"]) == _DENY:
        if autopilot.body.sensors.gps_fix < _FIX_3D:
            yield "Preflight Fail: GPS fix too low"
        if not autopilot.has_position:
            yield "Preflight Fail: Global position estimate required"
        if autopilot.home is None:
            yield "Preflight Fail: Home position required"


def _battery(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the remaining charge."""
    left, parameters = autopilot.body.battery.remaining, autopilot.vehicle.parameters
    if left <= float(parameters["BAT_EMERGEN_THR"]):
        yield "Emergency battery level"
    elif left <= float(parameters["BAT_CRIT_THR"]):
        yield "Critical battery"
    elif left <= max(float(parameters["BAT_LOW_THR"]), float(parameters["COM_ARM_BAT_MIN"])):
        yield "Low battery"


def _mode(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the requirements of the mode."""
    mode = autopilot.mode
    if not mode.may_arm:
        yield "Preflight Fail: Mode not suitable for arming"
    if mode.needs_position and not autopilot.has_position:
        yield "Preflight Fail: No valid global position estimate"
    if mode.manual_control and not autopilot.radio.present:
        yield "Preflight Fail: No manual control input"
    if mode.number == MISSION and not _has_mission(autopilot):
        yield "Preflight Fail: No valid mission available"
    if mode.number == RETURN and autopilot.home is None:
        yield "Preflight Fail: Home position not set"
    if mode.number == OFFBOARD and not autopilot.guided.stream_alive:
        yield "Preflight Fail: No offboard signal"


def _has_mission(autopilot: SimulatedAutopilot) -> bool:
    """Return whether there is a valid mission."""
    return autopilot.mission.valid()


def _mission(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the mission, if COM_ARM_MIS_REQ requires one."""
    if int(autopilot.vehicle.parameters["COM_ARM_MIS_REQ"]) and not _has_mission(autopilot):
        yield "Preflight Fail: No valid mission available"


def _fence(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the geofence."""
    yield from autopilot.fence.problems()


def _remote_id(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the Remote ID module, if COM_ARM_ODID denies arming without it."""
    vehicle = autopilot.vehicle
    if int(vehicle.parameters["COM_ARM_ODID"]) == _DENY_WITHOUT_ID:
        if vehicle.remote_id is None:
            yield "Preflight Fail: Open Drone ID system missing"
        elif vehicle.remote_id.problem:
            yield "Preflight Fail: Open Drone ID system not ready"


def _ground_station(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Check the ground station link, if NAV_DLL_ACT is set."""
    if int(autopilot.vehicle.parameters["NAV_DLL_ACT"]) > 0:
        stations = autopilot.vehicle.services.discovery.components.values()
        if not any(station.type == common.MavType.GCS for station in stations):
            yield "Preflight Fail: No connection to the GCS"


_CHECKS: Final[tuple[Check, ...]] = (
    _system,
    _estimate,
    _compass,
    _gps,
    _battery,
    _mode,
    _mission,
    _fence,
    _ground_station,
    _remote_id,
)


class PreflightReporter:
    """Reports problems that prevent arming, when they arise while disarmed."""

    def __init__(self, autopilot: SimulatedAutopilot, state: Px4State) -> None:
        self._autopilot, self._state = autopilot, state
        self._reported: frozenset[str] = frozenset()
        self._due = autopilot.booted_at

    def tick(self, now: float) -> None:
        """Check once per second, and report new problems."""
        if now < self._due or self._autopilot.armed or not self._autopilot.booted:
            return
        self._due = now + 1.0
        found = frozenset(
            problem for problem in preflight_problems(self._autopilot) if problem not in _MODE_PROBLEMS
        )
        for problem in sorted(found - self._reported):
            self._autopilot.vehicle.send_statustext(problem, common.MavSeverity.CRITICAL)
        self._reported = found
        self._state.healthy = not found


#: Problems with the present mode; they are reported only when arming is denied.
_MODE_PROBLEMS: Final = frozenset(
    {
        "Preflight Fail: Mode not suitable for arming",
        "Preflight Fail: No manual control input",
        "Preflight Fail: No valid mission available",
        "Preflight Fail: No offboard signal",
        "Preflight Fail: Home position not set",
        "Preflight Fail: No connection to the GCS",
    }
)


def arm(vehicle: SimulatedVehicle, state: Px4State, reason: str, *, force: bool = False) -> bool:
    """Arm, or report why not; return whether the vehicle is armed."""
    if state.calibrating:
        vehicle.send_statustext("Arming denied: calibrating", _CRITICAL)
        return False
    state.arming_reason = reason
    problems = vehicle.autopilot.arm(force=force)
    for problem in problems:
        vehicle.send_statustext(problem, _CRITICAL)
    if problems:
        vehicle.send_statustext(ARMING_DENIED, _CRITICAL)
    return not problems


def disarm(vehicle: SimulatedVehicle, state: Px4State, reason: str, *, force: bool = False) -> bool:
    """Disarm, in the air only if forced, or report why not; return whether the vehicle is disarmed."""
    autopilot = vehicle.autopilot
    if autopilot.armed and not force and vehicle.vehicle_type.flies and not autopilot.landed:
        vehicle.send_statustext(DISARMING_DENIED, _CRITICAL)
        return False
    state.disarming_reason = reason
    autopilot.disarm("commanded")
    state.disarming_reason = None
    return True


class LandDetector:
    """Detects take-off and landing of an aircraft, reports them, and disarms after landing."""

    def __init__(self, autopilot: SimulatedAutopilot, state: Px4State) -> None:
        self._autopilot, self._state = autopilot, state
        self._parameters = autopilot.vehicle.parameters
        self._was_landed = True
        self._landed_at = autopilot.now

    def tick(self, now: float) -> None:
        """Detect a change, and disarm when the delay has passed."""
        autopilot = self._autopilot
        if not autopilot.armed:
            self._was_landed, self._state.has_flown = autopilot.landed, False
            self._landed_at = now
            return
        if autopilot.landed != self._was_landed:
            self._was_landed, self._landed_at = autopilot.landed, now
            self._changed()
        if autopilot.landed:
            self._disarm_if_due(now)

    def _changed(self) -> None:
        """Report a take-off or landing."""
        autopilot = self._autopilot
        if autopilot.landed:
            autopilot.vehicle.send_statustext("Landing detected")
            return
        autopilot.vehicle.send_statustext("Takeoff detected")
        self._state.has_flown = True
        if self._number("COM_HOME_EN") and autopilot.has_position and not autopilot.home_locked:
            autopilot.set_home_here()

    def _disarm_if_due(self, now: float) -> None:
        """Disarm after the delay of landing or inactivity."""
        delay = self._number("COM_DISARM_LAND")
        if self._state.has_flown:
            if 0 < delay <= now - self._landed_at:
                self._disarm(BY_LANDING)
            return
        delay = self._number("COM_DISARM_PRFLT")
        if delay > 0 and now - self._autopilot.armed_at >= delay + self._number("COM_SPOOLUP_TIME"):
            self._disarm(BY_INACTION)

    def _disarm(self, reason: str) -> None:
        """Disarm for a reason."""
        self._state.disarming_reason = reason
        self._autopilot.disarm(reason)

    def _number(self, name: str) -> float:
        """Return a parameter as a number."""
        return float(self._parameters[name])
