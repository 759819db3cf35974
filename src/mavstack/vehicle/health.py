"""The health of a vehicle: whether it is ready to arm, and if not, why not.

A vehicle is ready if the pre-arm bit of its SYS_STATUS says so. The problems come from all messages that
report some (`telemetry.problems`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.telemetry.problems import Problem, problems_of, recent

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry import Telemetry

__all__ = ["Health", "Problem", "health_of"]

_PREARM: Final = common.MavSysStatusSensor.PREARM_CHECK
_UNKNOWN_PROBLEM: Final = Problem(
    "its checks before arming fail, and it has not reported which", "SYS_STATUS"
)


@dataclass(frozen=True, slots=True)
class Health:
    """The health of a vehicle.

    Attributes:
        ready: True if the vehicle reports that it is ready to arm; None if it does not report it.
        problems: All problems that it reports.
    """

    ready: bool | None
    problems: tuple[Problem, ...] = ()

    def __str__(self) -> str:
        not_ready = "readiness not reported" if self.ready is None else "not ready"
        return "; ".join(("ready" if self.ready else not_ready, *map(str, self.problems)))


def health_of(telemetry: Telemetry) -> Health:
    """Return the health that a vehicle's last messages report."""
    ready = _ready(telemetry)
    problems = problems_of(telemetry, ready=ready)
    return Health(ready, problems or ((_UNKNOWN_PROBLEM,) if ready is False else ()))


def _ready(telemetry: Telemetry) -> bool | None:
    info, status = telemetry.component.info, recent(telemetry, common.SysStatus)
    if info is None or not info.alive or status is None:
        return None
    if status.onboard_control_sensors_health & _PREARM:
        return True
    return False if telemetry.firmware.reports_prearm_check(status) else None
