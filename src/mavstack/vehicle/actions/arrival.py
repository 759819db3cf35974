"""Arrival: when a vehicle is where it was sent, by the way it moves.

    hovers, dives, drives   within the tolerance of the place, and of the altitude if it has one, and settled:
                            slow for a second, or within the tolerance for `LINGERING_TIME`
                            drives, and no tolerance was asked for: it was within the tolerance, and stands
                            still beside it, since it brakes only there
    flies on its wing       on a circle around the place, within the tolerance of the altitude; or within a
                            tolerance that was asked for, since then passing the place is enough

ArduRover also ends its drive when it has passed the place, however far beside it, as after a wide turn: it
reports MISSION_ITEM_REACHED and stands. It is sent there again then, `MAX_APPROACHES` times in all; not
if it stands within its stopping radius, since it does not move to a place in it.

Vehicles that drive have no altitude: some firmwares report one above home that is none (ArduRover 4.1).

The default tolerances are what the firmwares keep while they stay at a place. Rovers and boats stop within a
radius that a parameter of the firmware sets (`Firmware.STOPPING_RADII`), so their tolerance is at least that;
a smaller one that is asked for is refused before anything is sent.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import distance
from mavstack.services.arguments import check_number
from mavstack.vehicle.actions.circling import CircleTracker
from mavstack.vehicle.actions.conditions import SustainedCondition
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.vehicle_type import VehicleType, flies_on_wing

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.node import Listener
    from mavstack.vehicle.vehicle import Vehicle

#: The time for which a vehicle within its tolerance must be slow, in seconds.
SETTLED_TIME: Final = 1.0
#: A rover brakes when it enters its stopping radius. If it then does not move for this time in seconds,
#: within `_BRAKING_FACTOR` times the tolerance, it does not come nearer.
STANDING_TIME: Final = 3.0
_BRAKING_FACTOR: Final = 3.0
#: A vehicle that stays within its tolerance for this time in seconds has arrived, even if it moves: a boat
#: in waves, a copter in gusts.
LINGERING_TIME: Final = 15.0
#: Number of approaches of a vehicle that drives and stops beside the place.
MAX_APPROACHES: Final = 3
_SET_RADIUS: Final = "set that parameter, or allow a larger tolerance"


class StoppingRadius(NamedTuple):
    """The radius around a place in which a firmware ends its drive.

    Attributes:
        name: The parameter that sets it.
        metres: Its value, or the usual one if it was not read.
        is_read: True if the vehicle has reported it.
    """

    name: str
    metres: float
    is_read: bool


@dataclass(frozen=True, slots=True)
class Tolerance:
    """The largest errors at which a vehicle has arrived.

    Attributes:
        ground: Metres over ground; of a wing: from the place that it passes.
        height: Metres of altitude; None: the altitude does not count.
        speed: Metres per second at which the vehicle is settled.
        stopping: The radius in which the firmware of a vehicle that drives ends its drive; None: it has none.
    """

    ground: float
    height: float | None
    speed: float
    stopping: StoppingRadius | None = None


#: The tolerances of vehicles that can stop.
DEFAULTS: Final[Mapping[VehicleType, Tolerance]] = MappingProxyType(
    {
        VehicleType.COPTER: Tolerance(0.5, 0.5, 0.5),
        VehicleType.VTOL: Tolerance(1.0, 1.0, 0.5),
        VehicleType.ROVER: Tolerance(0.5, None, 0.3),
        VehicleType.BOAT: Tolerance(1.0, None, 0.3),
        VehicleType.SUB: Tolerance(0.5, 0.2, 0.2),
    }
)
_OTHER: Final = Tolerance(1.0, 1.0, 0.5)
#: The altitude tolerance of a vehicle that flies on a wing, in metres.
WING_HEIGHT: Final = 5.0


def default_tolerance(vehicle: Vehicle) -> Tolerance:
    """Return the default tolerance of a vehicle that can stop, by its type."""
    return DEFAULTS.get(vehicle.vehicle_type, _OTHER)


def check_tolerance(tolerance: float | None) -> None:
    """Raise unless a tolerance in metres is one that can be met."""
    if tolerance is None:
        return
    check_number("tolerance", tolerance, finite=False)
    if not 0 < tolerance < inf:
        raise InvalidArgumentError(f"tolerance must be positive and finite, got {tolerance}")


async def tolerance_of(vehicle: Vehicle, asked: float | None) -> Tolerance:
    """Return the tolerance of a vehicle that stops at a place.

    Raises:
        ActionUnsupported: It stops within a larger radius than `asked`; nothing but reads was sent.
    """
    default = default_tolerance(vehicle)
    stopping = await _stopping_radius(vehicle)
    radius = 0.0 if stopping is None else stopping.metres
    if asked is None:
        return Tolerance(max(default.ground, radius), default.height, default.speed, stopping)
    if stopping is not None and stopping.is_read and asked < radius:
        reason = f"it stops within {stopping.name}, {radius:g} m; {_SET_RADIUS}"
        raise firmware_of(vehicle).unsupported(f"stop within {asked:g} m of a location", reason)
    return Tolerance(asked, None if default.height is None else asked, default.speed, stopping)


async def tolerance_if_waiting(
    vehicle: Vehicle, asked: float | None, wait: bool, timeout: float | None
) -> Tolerance:
    """Return the tolerance of a call; without `wait` nothing is read for it."""
    if not wait:
        return default_tolerance(vehicle)
    async with deadline(timeout, "reading the tolerance of", vehicle.address):
        return await tolerance_of(vehicle, asked)


async def _stopping_radius(vehicle: Vehicle) -> StoppingRadius | None:
    """Return the largest radius in which a vehicle ends its drive; None for one that does not drive."""
    firmware = firmware_of(vehicle)
    radii = []
    for name, usual in firmware.STOPPING_RADII.get(vehicle.vehicle_type, {}).items():
        value = await firmware.read_number(name)
        radii.append(StoppingRadius(name, usual if value is None else value, value is not None))
    return max(radii, key=lambda each: each.metres, default=None)


class Arrival:
    """The arrival of a vehicle at a place.

    Args:
        vehicle: The vehicle.
        place: Returns latitude and longitude of the place; None while they are not known.
        altitude: The altitude in metres above home; None if it does not count.
        tolerance: The tolerance of a vehicle that stops.
        asked: The tolerance that was asked for, in metres; None: the default.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        place: Callable[[], tuple[float, float] | None],
        altitude: float | None,
        tolerance: Tolerance,
        asked: float | None = None,
    ) -> None:
        self._vehicle, self._place, self._tolerance = vehicle, place, tolerance
        self._altitude = None if tolerance.height is None else altitude
        self._asked = asked
        self._settled = SustainedCondition(vehicle, SETTLED_TIME)
        self._lingering = SustainedCondition(vehicle, LINGERING_TIME)
        self._standing = SustainedCondition(vehicle, STANDING_TIME)
        self._missing = SustainedCondition(vehicle, STANDING_TIME)
        self._entered = self._ended = False
        #: Metres from the place at which a vehicle stopped that passed it; None while it did not.
        self.missed_by: float | None = None
        self.circle = CircleTracker(vehicle)

    def reached(self) -> bool:
        """Return whether the vehicle has arrived."""
        place = self._place()
        if place is None:
            return False
        self.circle.update(*place)
        if not self._on_wing:
            return self._has_stopped()
        self._settled.update(False)
        self._lingering.update(False)
        return self._has_passed_or_circles()

    def remaining(self) -> float | None:
        """Return the metres to go, over ground and in altitude; None if they are not known."""
        away, height = self._away(), self._height()
        if away is None or height is None:
            return None
        if self._on_wing and self.circle.established:
            return height
        return away + height

    def signs(self) -> object:
        """Return a value that changes while a wing makes progress towards its circle."""
        circle = self.circle
        return None if circle.established else round(circle.swept / 15.0)

    def begin_approach(self) -> Listener:
        """Note whether the vehicle reports the end of its drive, until the result is closed."""
        self._ended, self.missed_by = False, None
        self._missing.update(False)
        return self._vehicle.add_listener(common.MissionItemReached, self._note_end)

    def miss(self) -> str | None:
        """Return how a vehicle missed the place that has ended its drive; None if it did not."""
        away, limit = self._away(), self._tolerance.ground
        drives = self._tolerance.height is None and not self._on_wing
        stands = self._missing.update(drives and self._ended and self._is_slow())
        if not stands or away is None or away <= limit:
            return None
        if why := self._stopped_within(away):
            return f"it ended its drive {away:.2f} m away, the tolerance is {limit:g} m; {why}"
        self.missed_by = away
        remedy = "allow a larger tolerance, or let it drive slower or turn in tighter circles"
        return f"it passed the location and stopped {away:.2f} m away, the tolerance is {limit:g} m; {remedy}"

    def _stopped_within(self, away: float) -> str:
        """Return why a vehicle does not come nearer that ended its drive in the radius of its firmware.

        It does not move to a place within that radius, nor to one a little behind it: a further approach is
        of no use.
        """
        stopping = self._tolerance.stopping
        if stopping is None or away > stopping.metres:
            return ""
        usual = "" if stopping.is_read else ", usually"
        return f"it stops within {stopping.name}{usual} {stopping.metres:g} m; {_SET_RADIUS}"

    def _note_end(self, report: common.MissionItemReached) -> None:
        self._ended = self._ended or report.seq == 0

    def detail(self) -> str:
        """Return where the vehicle stays that does not arrive, for an error; empty if it is on its way."""
        away, height = self._away(), self._height()
        if away is None or height is None:
            return ""
        if self._on_wing:
            return _excess("its altitude is {:.1f} m off", height, self._wing_height)
        limits = self._tolerance
        parts = (
            _excess("it is {:.2f} m away", away, limits.ground),
            self._stopped_within(away) if away > limits.ground else "",
            _excess("its altitude is {:.2f} m off", height, limits.height),
        )
        return "; ".join(filter(None, parts))

    @property
    def _on_wing(self) -> bool:
        return flies_on_wing(self._vehicle.vehicle_type, self._vehicle.vtol_state)

    @property
    def _wing_height(self) -> float:
        return WING_HEIGHT if self._asked is None else self._asked

    def _has_passed_or_circles(self) -> bool:
        away, height, circle = self._away(), self._height(), self.circle
        if away is None or height is None or height > self._wing_height:
            return False
        if self._asked is not None and away <= self._asked:
            return True
        level = self._altitude is not None or (circle.climbed or 0.0) <= self._wing_height
        return circle.established and level

    def _has_stopped(self) -> bool:
        away, height, limits = self._away(), self._height(), self._tolerance
        near = away is not None and away <= limits.ground
        near = near and height is not None and height <= (inf if limits.height is None else limits.height)
        settled = self._settled.update(near and self._is_slow())
        return self._lingering.update(near) or settled or self._stands_beside(away)

    def _stands_beside(self, away: float | None) -> bool:
        """Return whether a vehicle that drives has stopped after it reached the place."""
        if away is None or self._tolerance.height is not None or self._asked is not None:
            return False
        self._entered = self._entered or away <= self._tolerance.ground
        near = self._entered and away <= _BRAKING_FACTOR * self._tolerance.ground
        return self._standing.update(near and self._is_slow())

    def _is_slow(self) -> bool:
        speed, climb = self._vehicle.ground_speed, self._vehicle.climb_rate
        limit = self._tolerance.speed
        dives_or_flies = self._tolerance.height is not None
        return (speed or 0.0) <= limit and (not dives_or_flies or abs(climb or 0.0) <= limit)

    def _away(self) -> float | None:
        place, position = self._place(), self._vehicle.position
        if place is None or position is None:
            return None
        return distance(position.latitude, position.longitude, *place)

    def _height(self) -> float | None:
        """Return the error of the altitude in metres; 0 if the altitude does not count."""
        if self._altitude is None:
            return 0.0
        position = self._vehicle.position
        height = None if position is None else position.relative_altitude
        return None if height is None else abs(self._altitude - height)


def _excess(text: str, error: float, limit: float | None) -> str:
    """Return by how much an error exceeds its tolerance; empty if it does not."""
    if limit is None or error <= limit:
        return ""
    return f"{text.format(error)}, the tolerance is {limit:g} m"
