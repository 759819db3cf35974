"""Failsafe: the answer to a lost RC signal, or to the box FAILSAFE.

    signal lost ── guard time (`delay`) ── stage 2: the procedure ── landed, or the signal is back

Only an armed controller enters stage 2; a disarmed one refuses to arm until the signal is back. After stage
2 the signal must have been there for `recovery` before the pilot has control again.
"""

from __future__ import annotations

from enum import IntEnum


class Procedure(IntEnum):
    """The procedure of stage 2, by the numbers of MSP_FAILSAFE_CONFIG of Betaflight."""

    AUTO_LAND = 0
    DROP = 1
    GPS_RESCUE = 2


class Failsafe:
    """The failsafe of one controller.

    Args:
        delay: Seconds from the loss of the signal to stage 2.
        recovery: Seconds with a signal until the pilot has control again.
    """

    def __init__(self, delay: float, recovery: float) -> None:
        self.delay, self.recovery = delay, recovery
        #: True in stage 2 of the failsafe, in which the failsafe procedure flies the vehicle.
        self.is_active = False
        self._lost_at: float | None = None
        self._back_at: float | None = None

    def step(self, now: float, *, has_signal: bool, switched_on: bool, armed: bool) -> None:
        """Advance to a time.

        Args:
            now: The time in seconds.
            has_signal: The RC signal is there.
            switched_on: The box FAILSAFE is on.
            armed: The motors are armed.
        """
        if has_signal and not switched_on:
            self._lost_at = None
            self._recover(now, armed)
            return
        self._back_at = None
        self._lost_at = now if self._lost_at is None else self._lost_at
        if armed and now - self._lost_at >= (0.0 if switched_on and has_signal else self.delay):
            self.is_active = True

    def _recover(self, now: float, armed: bool) -> None:
        if not self.is_active:
            return
        self._back_at = now if self._back_at is None else self._back_at
        if not armed or now - self._back_at >= self.recovery:
            self.is_active, self._back_at = False, None
