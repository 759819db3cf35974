"""A landing of ArduPilot's copter whose target is lost, or was never seen: retries, and the last resort.

It counts while the target should be in sight: between PLND_ALT_MIN and PLND_ALT_MAX by the rangefinder, or at
any height if both are 0. A lost target is awaited for PLND_TIMEOUT seconds while the vehicle descends. Then
the vehicle climbs to 1.5 m above the height at which it last saw the target, over the target or where it was
itself (PLND_RET_BEHAVE 1), and descends to that height, at most PLND_RET_MAX times. After that, and for a
target that was never seen, it lands (PLND_STRICT 0), stays for 7 s and lands (1), or stays (2).

Source: ArduPilot 4.6, AC_PrecLand_StateMachine.cpp, AC_PrecLand.cpp (check_target_status).
"""

from __future__ import annotations

from enum import Enum, auto
from math import dist, hypot, inf, isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.landing_target import LandingAim

if TYPE_CHECKING:
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.vehicle import SimulatedVehicle

_NEAR: Final = 0.75
_HIGHER: Final = 1.5
#: Seconds that the vehicle stays before it lands without the target.
_FAILSAFE_TIME: Final = 7.0
#: A target that was lost for this time in seconds, or at this distance in metres, counts as never seen.
_FORGOTTEN: Final = 180.0
_TOO_FAR: Final = 30.0
#: Seconds between two calls after which a landing is a new one.
_NEW_LANDING: Final = 1.0
_NOT_STRICT, _VERY_STRICT = 0, 2
_TO_VEHICLE: Final = 1


class _Target(Enum):
    NEVER_SEEN = auto()
    OUT_OF_RANGE = auto()
    RECENTLY_LOST = auto()
    FOUND = auto()


class _Step(Enum):
    """The steps after the loss of the target."""

    NONE = auto()
    AWAIT = auto()
    BEGIN = auto()
    CLIMB = auto()
    DESCEND = auto()
    COMPLETE = auto()


class LandingRetries:
    """Decides where a landing vehicle flies without its target.

    Args:
        vehicle: The copter.
    """

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._state = _Target.NEVER_SEEN
        self._step = _Step.NONE
        self._count = 0
        self._called_at = self._seen_at = -inf
        self._failsafe: tuple[float, Point] | None = None
        #: The target at the height of the vehicle, and the vehicle, when the target was last seen.
        self._target: Point = (0.0, 0.0, 0.0)
        self._place: Point = (0.0, 0.0, 0.0)

    def note(self, target: Point | None, now: float) -> None:
        """Note the target that is used now; None: no target."""
        if target is not None:
            here = self._here
            self._target, self._place, self._seen_at = (*target[:2], here[2]), here, now
            self._state = _Target.FOUND
            return
        was_seen = self._state in (_Target.FOUND, _Target.RECENTLY_LOST)
        self._state = (
            _Target.RECENTLY_LOST if was_seen and not self._is_forgotten(now) else _Target.NEVER_SEEN
        )
        if not self._is_in_range():
            self._state = _Target.OUT_OF_RANGE

    def aim(self, now: float) -> LandingAim | None:
        """Return the place to fly to; None: the landing continues."""
        if now - self._called_at > _NEW_LANDING:
            self._count = 0
            self._reset()
        self._called_at = now
        if self._state is _Target.NEVER_SEEN:
            return self._fail(now)
        if self._state is _Target.RECENTLY_LOST:
            return self._act_on_loss(now)
        self._reset()
        return None

    def _act_on_loss(self, now: float) -> LandingAim | None:
        if int(self._number("PLND_STRICT")) == _NOT_STRICT:
            return None
        if self._step is _Step.NONE:
            self._step = _Step.AWAIT
        if self._step is _Step.AWAIT:
            if now - self._seen_at >= self._number("PLND_TIMEOUT"):
                self._step = _Step.BEGIN
            return None
        limit = int(self._number("PLND_RET_MAX"))
        if self._step is _Step.COMPLETE or limit == 0 or self._count > limit:
            return self._fail(now)
        return self._retry(limit)

    def _retry(self, limit: int) -> LandingAim:
        to_vehicle = int(self._number("PLND_RET_BEHAVE")) == _TO_VEHICLE
        north, east, down = self._place if to_vehicle else self._target
        above, here = (north, east, down - _HIGHER), self._here
        if self._step is _Step.DESCEND:
            if abs(here[2] - down) < _NEAR:
                self._step = _Step.COMPLETE
                self._report("Retry Completed")
            return LandingAim((*here[:2], down), descends=False, keeps_height=False)
        if self._step is _Step.BEGIN:
            self._count += 1
            self._step = _Step.CLIMB
            if self._count <= limit:
                self._report("Retrying")
        elif dist(above, here) < _NEAR:
            self._step = _Step.DESCEND
        return LandingAim(above, descends=False, keeps_height=False)

    def _fail(self, now: float) -> LandingAim | None:
        if self._failsafe is None:
            self._failsafe = now, self._here
            self._report("Failsafe Measures")
        strictness = int(self._number("PLND_STRICT"))
        begun, place = self._failsafe
        stays = strictness == _VERY_STRICT or now - begun < _FAILSAFE_TIME
        if strictness == _NOT_STRICT or not stays:
            return None
        return LandingAim(place, descends=False, keeps_height=False)

    def _reset(self) -> None:
        self._step, self._failsafe = _Step.NONE, None

    def _is_in_range(self) -> bool:
        low, high = self._number("PLND_ALT_MIN"), self._number("PLND_ALT_MAX")
        if not low and not high:
            return True
        height = self._vehicle.body.sensors.distance
        if not self._number("RNGFND1_TYPE") or not isfinite(height):
            return False
        return not (high and height > high) and not (low and height < low)

    def _is_forgotten(self, now: float) -> bool:
        here = self._here
        away = max(hypot(each[0] - here[0], each[1] - here[1]) for each in (self._target, self._place))
        return now - self._seen_at > _FORGOTTEN or away > _TOO_FAR

    @property
    def _here(self) -> Point:
        return self._vehicle.autopilot.maneuvers.place

    def _report(self, text: str) -> None:
        self._vehicle.send_statustext(f"PrecLand: {text}", common.MavSeverity.INFO)

    def _number(self, name: str) -> float:
        return float(self._vehicle.parameters.get(name, 0.0))
