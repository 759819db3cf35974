"""Copter's detection of thrust loss and crashes.

Thrust is lost if the copter sinks for a second with a failed motor; it has crashed if it hit the ground hard
and stays down for two seconds (FS_CRASH_CHECK). The simulated body always comes to rest upright, so the
reported angle is derived from the impact speed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

_EMERGENCY: Final = common.MavSeverity.EMERGENCY
_ACRO: Final = int(ardupilotmega.CopterMode.ACRO)
#: A vehicle that meets the ground with a higher sink rate, in m/s, has crashed.
_MAX_LANDING_SPEED: Final = 2.5
_THRUST_LOSS_TIME, _CRASH_TIME = 1.0, 2.0
_ANGLE, _ACCELERATION = 30, 3.0
#: The attitude error in the crash report, in degrees for each m/s of impact speed, and its maximum.
_DEGREES_PER_SPEED, _MAX_DEGREES = 20.0, 180.0


class CrashCheck:
    """Detects crashes; one of the autopilot's periodic checks."""

    def __init__(self, firmware: FirmwareFailsafes) -> None:
        self._firmware = firmware
        self._autopilot = firmware.autopilot
        self._sinking_since: float | None = None
        self._reported = False
        #: Sink rate at the last check in m/s; time and sink rate of the impact, None without an impact.
        self._sink = 0.0
        self._impact: tuple[float, float] | None = None
        self._autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Check thrust and ground contact."""
        autopilot = self._autopilot
        if not autopilot.armed:
            self._sinking_since = self._impact = None
            self._sink, self._reported = 0.0, False
            return
        self._check_thrust(now)
        self._check_ground(now)

    def _check_thrust(self, now: float) -> None:
        """Report a loss of thrust."""
        motor = next((number for number in range(1, 5) if f"motor {number}" in self._faults), None)
        sinking = not self._autopilot.body.on_ground and self._autopilot.body.truth.velocity_down > 0
        if motor is None or not sinking:
            self._sinking_since = None
            self._reported = self._reported and motor is not None
            return
        if self._sinking_since is None:
            self._sinking_since = now
        if not self._reported and now - self._sinking_since >= _THRUST_LOSS_TIME:
            self._reported = True
            self._firmware.send_statustext(f"Potential Thrust Loss ({motor})", _EMERGENCY)

    @property
    def _faults(self) -> dict[str, str]:
        """Injected faults by name."""
        return self._autopilot.vehicle.faults.active

    def _check_ground(self, now: float) -> None:
        """Disarm after a crash."""
        autopilot = self._autopilot
        if not autopilot.body.on_ground:
            self._impact, self._sink = None, autopilot.body.truth.velocity_down
            return
        if self._impact is None and self._sink > _MAX_LANDING_SPEED:
            self._impact = now, self._sink
        self._sink = 0.0
        if self._impact is None or now - self._impact[0] < _CRASH_TIME:
            return
        if self._firmware.number("FS_CRASH_CHECK") and autopilot.mode.number != _ACRO:
            angle = min(_DEGREES_PER_SPEED * self._impact[1], _MAX_DEGREES)
            self._firmware.send_statustext(
                f"Crash: Disarming: AngErr={angle:.0f}>{_ANGLE}, Accel=0.0<{_ACCELERATION:.1f}", _EMERGENCY
            )
            autopilot.disarm("crash")
