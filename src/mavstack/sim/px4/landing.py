"""PX4 notices leaving the ground and landing, says so, and disarms what stays on the ground.

After a flight the motors go off COM_DISARM_LAND seconds after landing, in any mode; a vehicle that was armed
and does not take off is disarmed after COM_DISARM_PRFLT seconds, beyond the time its motors take to spin up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.px4.state import BY_INACTION, BY_LANDING

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.px4.state import Px4State


class LandingWatch:
    """The land detector's news of a vehicle that flies."""

    def __init__(self, autopilot: Autopilot, state: Px4State) -> None:
        self._autopilot, self._state = autopilot, state
        self._parameters = autopilot.vehicle.parameters
        self._was_landed = True
        self._landed_at = autopilot.now

    def tick(self, now: float) -> None:
        """Look, say, and disarm."""
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
        autopilot = self._autopilot
        if autopilot.landed:
            autopilot.vehicle.send_statustext("Landing detected")
            return
        autopilot.vehicle.send_statustext("Takeoff detected")
        self._state.has_flown = True
        if self._number("COM_HOME_EN") and autopilot.has_position and not autopilot.home_locked:
            autopilot.set_home_here()

    def _disarm_if_due(self, now: float) -> None:
        delay = self._number("COM_DISARM_LAND")
        if self._state.has_flown:
            if 0 < delay <= now - self._landed_at:
                self._disarm(BY_LANDING)
            return
        delay = self._number("COM_DISARM_PRFLT")
        if delay > 0 and now - self._autopilot.armed_at >= delay + self._number("COM_SPOOLUP_TIME"):
            self._disarm(BY_INACTION)

    def _disarm(self, reason: str) -> None:
        self._state.disarming_reason = reason
        self._autopilot.disarm(reason)

    def _number(self, name: str) -> float:
        return float(self._parameters[name])
