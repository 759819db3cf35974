"""PX4's Precision Land mode (main 4, sub 9) of multicopters, with the parameters PLD_….

LANDING_TARGET counts in LOCAL_NED with `position_valid`; other frames are refused with a status text, and
angles go to a module that is not started by default. The vehicle waits 2 s for the target where it is, then
climbs to PLD_SRCH_ALT above the local origin, and searches for PLD_SRCH_TOUT. It flies above the target at
its present height, and descends once it has been within PLD_HACC_RAD for 2 s. If the target is lost for
PLD_BTOUT above the last PLD_FAPPR_ALT metres, the vehicle starts again, at most PLD_MAX_SRCH times; after
that, or if the search finds no target, the vehicle lands where it is.

Source: PX4 1.17, navigator/precland.cpp (mode Required), MavlinkReceiver::handle_message_landing_target.
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

#: Seconds that the vehicle hovers before the next step, and maximum age in seconds of a new report.
_SETTLING: Final = 2.0
_NEW: Final = 0.5


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

    vehicle.autopilot.landing_target = vehicle.engine.add(LandingTarget(vehicle, read))


class PrecisionLand(Behaviour):
    """Precision Land."""

    landing = True

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        super().__init__(autopilot)
        self._maneuvers = autopilot.maneuvers
        self._searches = 0

    def fly(self) -> Iterator[None]:
        """Land on the target, or where the vehicle is if it is not found."""
        while self._searches <= self._number("PLD_MAX_SRCH", 3):
            self._searches += 1
            yield from self._wait_for_target()
            if not self._is_new:
                yield from self._search()
            if not self._is_new:
                break
            yield from self._approach()
            if self._is_above:
                yield from self._descend()
            if self.autopilot.landed:
                break
        yield from Land(self.autopilot).fly()

    def _wait_for_target(self) -> Iterator[None]:
        self._maneuvers.hold()
        yield from self._until_new(_SETTLING)

    def _search(self) -> Iterator[None]:
        north, east, _ = self._maneuvers.place
        self._maneuvers.go_to((north, east, -self._number("PLD_SRCH_ALT", 10.0)))
        yield from self._until_new(self._number("PLD_SRCH_TOUT", 10.0))

    def _until_new(self, timeout: float) -> Iterator[None]:
        end = self.autopilot.now + timeout
        while not self._is_new and self.autopilot.now < end:
            yield

    def _approach(self) -> Iterator[None]:
        """Fly above the target; ends when the vehicle has settled, or has lost the target there."""
        height, settled_at = self._maneuvers.place[2], self.autopilot.now
        while True:
            north, east, _ = self._place
            self._maneuvers.go_to((north, east, height))
            if not self._is_above:
                settled_at = self.autopilot.now
            elif not self._is_valid or self.autopilot.now - settled_at > _SETTLING:
                return
            yield

    def _descend(self) -> Iterator[None]:
        """Descend above the target until the vehicle is down, or has lost the target."""
        landing, yaw = Land(self.autopilot), self.autopilot.body.estimate.yaw
        while not self.autopilot.landed and (self._is_valid or self._is_final):
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
