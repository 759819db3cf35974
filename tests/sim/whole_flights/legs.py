"""Comparison of a track with its plan: the legs of a flight, and the deviation from them."""

from __future__ import annotations

from dataclasses import dataclass
from math import dist, hypot
from typing import TYPE_CHECKING

from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from tests.sim.whole_flights.ground_station import Flight, Sample
    from tests.sim.whole_flights.plans import Place

Flat = tuple[float, float]
WINGS = (VehicleType.PLANE, VehicleType.VTOL)
#: Types whose take-off ends at the altitude, wherever that is.
_TAKEOFF_WITHOUT_END_POINT = (VehicleType.PLANE,)
HOME = (0.0, 0.0, 0.0)
#: Deviation at which a circle counts as joined, as a share of its radius.
_JOINED = 0.1


@dataclass(frozen=True)
class Leg:
    """The part of a flight between two reached items."""

    seq: int
    begin: Flat
    end: Place
    #: Radius of the circle around the end; 0 if the end is a point.
    circle: float
    track: list[Sample]
    #: The previous leg, whose line the vehicle may still be leaving.
    before: Leg | None = None

    def cross_track_error(self, place: Flat) -> float:
        """Return the distance of a point from this leg or the previous one, in metres."""
        own = max(distance_from_line(place, self.begin, self.end[:2]) - self.circle, 0.0)
        if self.before is None:
            return own
        return min(own, distance_from_line(place, self.before.begin, self.before.end[:2]))

    @property
    def max_cross_track_error(self) -> float:
        """The greatest cross-track error of the leg."""
        return max((self.cross_track_error(horizontal(sample)) for sample in self.track), default=0.0)

    @property
    def max_radius_error(self) -> float:
        """The greatest error of the radius on the circle."""
        errors = [abs(dist(horizontal(sample), self.end[:2]) - self.circle) for sample in self.track]
        joined = next((at for at, error in enumerate(errors) if error < _JOINED * self.circle), len(errors))
        return max(errors[joined:], default=0.0)

    def altitude_errors(self) -> list[float]:
        """Return the altitude errors along the leg."""
        return [-sample.motion.down - self.end[2] for sample in self.track]


def horizontal(sample: Sample) -> Flat:
    return sample.motion.north, sample.motion.east


def distance_from_line(place: Flat, begin: Flat, end: Flat) -> float:
    """Return the distance of a point from the line through two others."""
    along = end[0] - begin[0], end[1] - begin[1]
    size = along[0] ** 2 + along[1] ** 2
    share = ((place[0] - begin[0]) * along[0] + (place[1] - begin[1]) * along[1]) / size if size else 0.0
    share = min(max(share, 0.0), 1.0)
    return hypot(place[0] - begin[0] - share * along[0], place[1] - begin[1] - share * along[1])


def reached_in_order(flight: Flight) -> list[int]:
    """Return the NAV items in the order in which they were reported as reached."""
    return [seq for _, seq in flight.journal.reached if seq in flight.plan.order]


def legs_of(flight: Flight) -> list[Leg]:
    """Return the legs in the order in which they were reported, without takeoff and landing.

    Vehicles that can stop return on a straight line at the end.
    """
    plan = flight.plan
    legs: list[Leg] = []
    since, begin = flight.began, HOME[:2]
    for time, seq in flight.journal.reached:
        end = plan.places.get(seq)
        if seq not in plan.order or end is None or end == HOME:
            continue
        track = [sample for sample in flight.track if since < sample.time <= time]
        circle = plan.circles.get(seq, 0.0)
        if not (legs == [] and flight.kind.flies and seq == plan.order[0]):
            legs.append(Leg(seq, begin, end, circle, track, legs[-1] if legs else None))
        without_end_point = circle or (seq == plan.order[0] and flight.kind in _TAKEOFF_WITHOUT_END_POINT)
        begin = horizontal(track[-1]) if without_end_point else end[:2]
        since = time
    if flight.kind not in WINGS:
        track = [sample for sample in flight.track if since < sample.time <= flight.ended]
        legs.append(Leg(plan.order[-1], begin, HOME, 0.0, track, legs[-1]))
    return legs
