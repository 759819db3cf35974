"""Copter notices that a motor does not carry any more, and that it lies on the ground.

Thrust is lost if it sinks for a second though it gives all it has; it has crashed if it hit the ground hard
and does not come up for two seconds (FS_CRASH_CHECK). The body always comes to rest upright: the angle
that is told follows from how hard it hit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

_EMERGENCY: Final = common.MavSeverity.EMERGENCY
_ACRO: Final = int(ardupilotmega.CopterMode.ACRO)
#: Faster than this, in m/s, is no landing.
_HARD: Final = 2.5
_THRUST_PATIENCE, _CRASH_PATIENCE = 1.0, 2.0
_ANGLE, _ACCELERATION = 30, 3.0
#: Degrees that it lies askew for each m/s it came down with.
_DEGREES_OF_SPEED, _MOST_DEGREES = 20.0, 180.0


class CrashCheck:
    """One of its autopilot's watches."""

    def __init__(self, firmware: FirmwareFailsafes) -> None:
        self._firmware = firmware
        self._autopilot = firmware.autopilot
        self._sinking_since: float | None = None
        self._boosted = False
        #: How fast it came down at the last look, and when and how hard it hit the ground.
        self._sink = 0.0
        self._hit: tuple[float, float] | None = None
        self._autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Look, and act."""
        autopilot = self._autopilot
        if not autopilot.armed:
            self._sinking_since = self._hit = None
            self._sink, self._boosted = 0.0, False
            return
        self._look_at_thrust(now)
        self._check_ground(now)

    def _look_at_thrust(self, now: float) -> None:
        motor = next((number for number in range(1, 5) if f"motor {number}" in self._faults), None)
        sinking = not self._autopilot.body.on_ground and self._autopilot.body.truth.velocity_down > 0
        if motor is None or not sinking:
            self._sinking_since = None
            self._boosted = self._boosted and motor is not None
            return
        if self._sinking_since is None:
            self._sinking_since = now
        if not self._boosted and now - self._sinking_since >= _THRUST_PATIENCE:
            self._boosted = True
            self._firmware.send_statustext(f"Potential Thrust Loss ({motor})", _EMERGENCY)

    @property
    def _faults(self) -> dict[str, str]:
        return self._autopilot.vehicle.faults.active

    def _check_ground(self, now: float) -> None:
        autopilot = self._autopilot
        if not autopilot.body.on_ground:
            self._hit, self._sink = None, autopilot.body.truth.velocity_down
            return
        if self._hit is None and self._sink > _HARD:
            self._hit = now, self._sink
        self._sink = 0.0
        if self._hit is None or now - self._hit[0] < _CRASH_PATIENCE:
            return
        if self._firmware.number("FS_CRASH_CHECK") and autopilot.mode.number != _ACRO:
            angle = min(_DEGREES_OF_SPEED * self._hit[1], _MOST_DEGREES)
            self._firmware.send_statustext(
                f"Crash: Disarming: AngErr={angle:.0f}>{_ANGLE}, Accel=0.0<{_ACCELERATION:.1f}", _EMERGENCY
            )
            autopilot.disarm("crash")
