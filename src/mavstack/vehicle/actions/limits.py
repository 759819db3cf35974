"""The limits of plausible flights: a target beyond them is more likely a mistake than an intention.

The distance of a target needs the position of the vehicle; the check waits shortly for the first one. A
vehicle without a position decides itself. If it refuses a far target without a status text, the error names
the distance as the likely reason.
"""

from __future__ import annotations

from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Final

from mavstack.errors import ActionRefused, CommandDenied, InvalidArgumentError, RemoteDenied, RemoteTimeout
from mavstack.geodesy import distance
from mavstack.services.arguments import check_number, check_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.vehicle.geography import Location
    from mavstack.vehicle.vehicle import Vehicle

#: The highest target above home in metres, and the lowest target below home of a vehicle that does not fly.
MAX_ALTITUDE: Final = 10_000.0
#: The longest distance to a target in metres.
MAX_DISTANCE: Final = 100_000.0
#: The time in which a check waits for the first position of the vehicle, in seconds.
POSITION_CHECK_TIMEOUT: Final = 2.0
#: A target farther away than this, in metres, that a vehicle refuses without a status text is probably too
#: far for it.
_FAR_DISTANCE: Final = 10_000.0
_REMEDY: Final = "override_limits=True sends it anyway"


def check_takeoff(altitude: float, *, override_limits: bool) -> None:
    """Raise unless an altitude is one to take off to."""
    check_number("takeoff altitude", altitude, finite=False)
    if not 0 < altitude < float("inf"):
        raise InvalidArgumentError(f"takeoff altitude must be positive and finite, got {altitude}")
    if altitude > MAX_ALTITUDE and not override_limits:
        raise InvalidArgumentError(
            f"takeoff altitude must be at most {MAX_ALTITUDE:g} m, got {altitude:g} m; {_REMEDY}"
        )


def check_location(location: Location) -> None:
    """Raise unless a location is on Earth."""
    check_numbers(
        finite=False, latitude=location.latitude, longitude=location.longitude, altitude=location.altitude
    )
    valid = abs(location.latitude) <= 90.0 and abs(location.longitude) <= 180.0
    if not (valid and abs(location.altitude or 0.0) < float("inf")):
        raise InvalidArgumentError(
            "a location needs a latitude in -90..90, a longitude in -180..180 and a finite altitude, "
            f"got {location.latitude}, {location.longitude}, {location.altitude}"
        )


async def check_target(
    vehicle: Vehicle, location: Location, *, override_limits: bool, timeout: float | None
) -> None:
    """Raise unless a location is a plausible target of a vehicle where it is now."""
    check_location(location)
    if override_limits:
        return
    altitude, lowest = location.altitude, 0.0 if vehicle.vehicle_type.flies else -MAX_ALTITUDE
    if altitude is not None and not lowest <= altitude <= MAX_ALTITUDE:
        raise InvalidArgumentError(
            f"altitude must be {lowest:g} to {MAX_ALTITUDE:g} m above home, got {altitude:g} m; {_REMEDY}"
        )
    if vehicle.position is None:
        seconds = POSITION_CHECK_TIMEOUT if timeout is None else min(timeout, POSITION_CHECK_TIMEOUT)
        with suppress(RemoteTimeout, RemoteDenied):
            await vehicle.get_position(timeout=seconds)
    away = _distance_to(vehicle, location)
    if away is not None and away > MAX_DISTANCE:
        raise InvalidArgumentError(
            f"the target must be within {MAX_DISTANCE / 1000:g} km of the vehicle, "
            f"got {location.latitude}, {location.longitude}, {away / 1000:,.0f} km away; {_REMEDY}"
        )


@contextmanager
def explain_far_target(vehicle: Vehicle, location: Location) -> Iterator[None]:
    """Add the distance of a far target to a refusal for which the vehicle sent no status text."""
    try:
        yield
    except CommandDenied as error:
        away = None if isinstance(error, ActionRefused) else _distance_to(vehicle, location)
        if away is not None and away >= _FAR_DISTANCE:
            error.status_texts = error.status_texts or (f"the target is {away / 1000:,.0f} km away",)
        raise


def _distance_to(vehicle: Vehicle, location: Location) -> float | None:
    position = vehicle.position
    if position is None:
        return None
    return distance(position.latitude, position.longitude, location.latitude, location.longitude)
