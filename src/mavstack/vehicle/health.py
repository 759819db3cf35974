"""The health of a vehicle: whether it is ready to arm, and if not, why not.

A vehicle is ready if the pre-arm bit of its SYS_STATUS says so and its firmware arms in the present mode: the
bit of ArduCopter does not speak of the mode, and after a landing in RTL it says that the checks passed. None
is ready while several vehicles use its system id, since the reports may be of either. What
else the vehicle reports comes from all messages that report something (`telemetry.problems`): of a vehicle
that is ready these are warnings, since they do not prevent arming, and of all others problems.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.telemetry.problems import Problem, problems_of, recent

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry import Telemetry
    from mavstack.vehicle.vehicle import Vehicle

__all__ = ["Health", "Problem", "health_of"]

_PREARM: Final = common.MavSysStatusSensor.PREARM_CHECK
_UNKNOWN_PROBLEM: Final = Problem(
    "its checks before arming fail, and it has not reported which", "SYS_STATUS"
)
#: The end of ArduPilot's status texts about a mode in which it does not arm; `Health` names the mode itself.
_MODE_TEXT: Final = "mode not armable"


@dataclass(frozen=True, slots=True)
class Health:
    """The health of a vehicle.

    Attributes:
        ready: True if the vehicle can be armed in its present mode; None if it does not report that.
        problems: The problems that prevent arming, or may do so; empty if the vehicle is ready.
        warnings: Problems that do not prevent arming in the present mode, such as a missing position in a
            mode that needs none; empty unless the vehicle is ready.
        mode: The mode that this is about; None if it is not known.
    """

    ready: bool | None
    problems: tuple[Problem, ...] = ()
    warnings: tuple[Problem, ...] = ()
    mode: str | None = None

    def __str__(self) -> str:
        not_ready = "readiness not reported" if self.ready is None else "not ready"
        warnings = (f"warning: {warning}" for warning in self.warnings)
        return "; ".join(("ready" if self.ready else not_ready, *map(str, self.problems), *warnings))


def health_of(vehicle: Vehicle, telemetry: Telemetry) -> Health:
    """Return the health that a vehicle's last messages report."""
    info, mode = telemetry.component.info, vehicle.mode
    conflict = vehicle.id_conflict
    if conflict is not None and vehicle.chosen_sender is None:
        count, system = len(conflict.senders), vehicle.system
        text = f"{count} vehicles use system id {system}: {conflict}; choose one by its channel"
        return Health(False, (Problem(text, "HEARTBEAT"),), mode=mode)
    ready = _passes_checks(telemetry)
    found = problems_of(telemetry, ready=ready)
    disarmed = info is not None and info.alive and vehicle.armed is False
    firmware = firmware_of(vehicle)
    if disarmed and not firmware.allows_arming(mode):
        found = tuple(each for each in found if not each.text.lower().endswith(_MODE_TEXT))
        problem = Problem(f"its firmware does not arm in mode {mode}", "HEARTBEAT")
        return Health(False, (problem, *found), mode=mode)
    if not ready:
        return Health(ready, found or ((_UNKNOWN_PROBLEM,) if ready is False else ()), mode=mode)
    if disarmed and firmware.starts_by_itself(mode):
        found = (*found, Problem(f"in mode {mode} it starts by itself when it is armed", "HEARTBEAT"))
    return Health(True, (), found, mode)


def _passes_checks(telemetry: Telemetry) -> bool | None:
    info, status = telemetry.component.info, recent(telemetry, common.SysStatus)
    if info is None or not info.alive or status is None:
        return None
    if status.onboard_control_sensors_health & _PREARM:
        return True
    return False if telemetry.firmware.reports_prearm_check(status) else None
