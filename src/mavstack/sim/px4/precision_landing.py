"""Precision landing of PX4's multicopters: the mode (main 4, sub 9), NAV_LAND, and the return (RTL_PLD_MD).

LANDING_TARGET counts in LOCAL_NED with `position_valid`; other frames are refused with a status text, and
angles go to a module that is not started by default. With the precision 1 (opportunistic) the vehicle lands
where it is if it does not see the target when the landing begins. With 2 (required) it waits 2 s for the
target, then climbs to PLD_SRCH_ALT above home, and searches for PLD_SRCH_TOUT; a second after it has seen the
target, it flies above it at its present height. It descends 2 s after it has come within PLD_HACC_RAD. If
the target is lost for PLD_BTOUT above the last PLD_FAPPR_ALT metres, the vehicle starts again, at most
PLD_MAX_SRCH times; after that, or if the search finds no target, it lands where it is.

Source: PX4 1.17, navigator/precland.cpp, MavlinkReceiver::handle_message_landing_target.
"""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours import Land
from mavstack.sim.autopilot.landing_target import LandingTarget
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.vehicle import SimulatedVehicle

#: Seconds that the vehicle hovers before the next step, and after the target was found in a search; maximum
#: age in seconds of a new report.
_SETTLING: Final = 2.0
_SETTLED: Final = 1.0
_NEW: Final = 0.5
#: Metres that a search climbs on after the target was seen.
_MARGIN: Final = 1.0
_OPPORTUNISTIC, _REQUIRED = 1, 2


def register_precision_landing(vehicle: SimulatedVehicle) -> None:
    """Receive LANDING_TARGET."""
    if vehicle.vehicle_type is not VehicleType.COPTER:
        return

    def read(message: common.LandingTarget) -> Point | None:
        place = message.x, message.y, message.z
        if not message.position_valid or not all(map(isfinite, place)):
            return None
        if message.frame != common.MavFrame.LOCAL_NED:
            text = f"Landing target: coordinate frame {int(message.frame)} unsupported"
            vehicle.send_statustext(text, common.MavSeverity.CRITICAL)
            return None
        return place

    def precise_landing(precision: int | None) -> PrecisionLand | None:
        chosen = int(vehicle.parameters.get("RTL_PLD_MD", 0)) if precision is None else precision
        if chosen not in (_OPPORTUNISTIC, _REQUIRED):
            return None
        return PrecisionLand(vehicle.autopilot, required=chosen == _REQUIRED)

    vehicle.autopilot.landing_target = vehicle.engine.add(LandingTarget(vehicle, read))
    vehicle.autopilot.precise_landing = precise_landing


class PrecisionLand(Behaviour):
    """A landing on the target.

    Args:
        autopilot: The autopilot.
        required: True if the vehicle searches for a target that it does not see.
    """

    landing = True

    def __init__(self, autopilot: SimulatedAutopilot, *, required: bool = True) -> None:
        super().__init__(autopilot)
        self._maneuvers = autopilot.maneuvers
        self._required = required
        self._searches = 0

    def fly(self) -> Iterator[None]:
        """Land on the target, or where the vehicle is if it is not found."""
        while self._searches <= self._number("PLD_MAX_SRCH", 3):
            self._searches += 1
            self._maneuvers.hold()
            if not self._is_new and self._required:
                yield from self._find()
            if not self._is_new:
                break
            yield from self._approach()
            yield from self._descend()
            if self.autopilot.landed:
                break
        yield from Land(self.autopilot).fly()

    def _find(self) -> Iterator[None]:
        """Wait for the target here, then at the height of the search."""
        begun, timeout = self.autopilot.now, self._number("PLD_SRCH_TOUT", 10.0)
        while not self._is_new and self.autopilot.now - begun <= (_SETTLING if timeout > 0 else 0):
            yield
        if self._is_new or timeout <= 0:
            return
        yield from self._search(timeout)

    def _search(self, timeout: float) -> Iterator[None]:
        """Climb until the target is seen, and a second longer for the vehicle to settle."""
        north, east, _ = self._maneuvers.place
        height = self.autopilot.home_position[2] - self._number("PLD_SRCH_ALT", 10.0)
        self._maneuvers.go_to((north, east, height))
        end, seen_at = self.autopilot.now + timeout, None
        while self.autopilot.now < end:
            if self._is_new and seen_at is None:
                seen_at = self.autopilot.now
                stop = max(self._maneuvers.place[2] - _MARGIN, height)
                self._maneuvers.go_to((north, east, stop))
            if self._is_new and seen_at is not None and self.autopilot.now - seen_at > _SETTLED:
                return
            yield

    def _approach(self) -> Iterator[None]:
        """Fly above the target; ends 2 s after the vehicle was there, or when it lost the target there."""
        height, reached_at = self._maneuvers.place[2], None
        while self._is_valid or not self._is_above:
            if self._is_above and self._is_new:
                reached_at = self.autopilot.now if reached_at is None else reached_at
                if self.autopilot.now - reached_at > _SETTLING:
                    return
            north, east, _ = self._place
            self._maneuvers.go_to((north, east, height))
            yield

    def _descend(self) -> Iterator[None]:
        """Descend above the target until the vehicle is down, or has lost the target."""
        landing, yaw = Land(self.autopilot), self.autopilot.body.estimate.yaw
        while not self.autopilot.landed and self._is_valid:
            if self._is_final and not self._is_new:
                yield from landing.fly()
            landing.sink_at(self._place, yaw)
            yield

    # The target

    @property
    def _place(self) -> Point:
        target = self.autopilot.landing_target
        return self._maneuvers.place if target is None or target.place is None else target.place

    @property
    def _age(self) -> float:
        target = self.autopilot.landing_target
        return float("inf") if target is None else self.autopilot.now - target.received_at

    @property
    def _is_new(self) -> bool:
        return self._age <= _NEW

    @property
    def _is_valid(self) -> bool:
        return self._age <= self._number("PLD_BTOUT", 5.0)

    @property
    def _is_above(self) -> bool:
        here, place, limit = self._maneuvers.place, self._place, self._number("PLD_HACC_RAD", 0.2)
        return abs(place[0] - here[0]) < limit and abs(place[1] - here[1]) < limit

    @property
    def _is_final(self) -> bool:
        return self._place[2] - self._maneuvers.place[2] < self._number("PLD_FAPPR_ALT", 0.1)

    def _number(self, name: str, default: float) -> float:
        return float(self.autopilot.vehicle.parameters.get(name, default))
