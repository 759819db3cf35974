"""Detects the end of a mission, whatever parts of it a firmware reports.

ArduPilot sends MISSION_CURRENT only if its rate is requested, and an older version may refuse that. Without
it the current item is the one after the last that was reached.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.actions.conditions import LandingDetector, SustainedCondition

if TYPE_CHECKING:
    from mavstack.vehicle.firmware import Firmware
    from mavstack.vehicle.mission import Mission
    from mavstack.vehicle.vehicle import Vehicle

_STATE: Final = common.MissionState
#: The time after the end of the mission in which the vehicle may still enter a landing mode, in seconds: PX4
#: reports the end, then enters the mode of the last item, and leaves that mode before its heartbeat shows
#: that it is disarmed.
END_DELAY: Final = 2.5
#: The speed in m/s below which a vehicle that drives or dives counts as stopped, after `STANDING_TIME`
#: seconds.
STANDING_SPEED: Final = 0.3
STANDING_TIME: Final = 4.0


class MissionCompletion:
    """Detects that a mission has ended and that the action of its last item is complete.

    As a container it holds the modes in which the mission goes on. The mode in which a vehicle waits after
    the end belongs to them only at the end, since before that it is a pause.
    """

    def __init__(self, vehicle: Vehicle, firmware: Firmware, mission: Mission) -> None:
        self._vehicle = vehicle
        self._firmware = firmware
        self._mission = mission
        self._modes = firmware.modes_of("mission")
        self._modes_at_end = firmware.modes_of("end of mission") or frozenset()
        self._landing = LandingDetector(vehicle)
        self._standing = SustainedCondition(vehicle, STANDING_TIME)
        self._running = False
        self._ended_at: float | None = None
        self._max_seq = 0
        self._reached: set[int] = set()

    def __contains__(self, mode: object) -> bool:
        at_end = self._ended_at is not None or (
            (seq := self._seq) is not None and seq >= self._mission.last_seq
        )
        return self._modes is None or mode in self._modes or (at_end and mode in self._modes_at_end)

    def remaining(self) -> float | None:
        """Return the number of items that are left; None if it is not known."""
        progress, seq = self._mission.progress, self._seq
        if progress is not None:
            return float(progress.total - progress.seq)
        return None if seq is None else float(self._mission.last_seq + 1 - seq)

    def update(self, reached: list[int]) -> bool:
        """Take in the items that were reached since the last call; return whether the mission has ended."""
        self._reached.update(reached)
        progress, seq = self._mission.progress, self._seq
        if seq is None:
            return False
        state = _STATE.UNKNOWN if progress is None else progress.state
        self._running = self._running or state == _STATE.ACTIVE or bool(self._reached)
        if self._running:
            last = self._mission.last_seq
            landing = self._mission.landing_seq
            # the mission continued with a return or a landing in a separate mode
            left_by_landing = seq >= landing and self._lands
            finished = state == _STATE.COMPLETE if state != _STATE.UNKNOWN else last in self._reached
            done = finished or left_by_landing
            # A firmware may report the first item again before it reports that it was disarmed.
            self._max_seq = max(self._max_seq, seq)
            if done or (self._vehicle.armed is False and self._max_seq >= landing):
                self._ended_at = self._ended_at or self._vehicle.connection.now()
        return self._ended_at is not None and self._is_at_rest(self._ended_at)

    def _is_at_rest(self, ended_at: float) -> bool:
        """Return whether the vehicle has landed or stands, or is in no landing mode for a while."""
        if self._stands() if not self._vehicle.vehicle_type.flies else self._landing.has_landed():
            return True
        now = self._vehicle.connection.now()
        if self._lands:
            self._ended_at = now
            return False
        return now >= ended_at + END_DELAY

    def _stands(self) -> bool:
        velocity = self._vehicle.velocity
        slow = velocity is not None and velocity.ground_speed < STANDING_SPEED
        return self._standing.update(slow)

    @property
    def _seq(self) -> int | None:
        """The sequence number of the current item; None if nothing tells it."""
        progress = self._mission.progress
        if progress is not None:
            return progress.seq
        return max(self._reached) + 1 if self._reached else None

    @property
    def _lands(self) -> bool:
        """True if the last item was a landing or a return, which goes on in a mode of its own."""
        return self._firmware.lands_in(self._vehicle.mode)
