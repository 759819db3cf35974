"""Progress of an action in flight: one line on a terminal, nothing in a pipe."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.live_line import LiveLine
from mavstack.geodesy import distance

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeAlias

    from mavstack.vehicle import Vehicle

    #: Returns the remaining distance in metres; None if it is not known.
    Remaining: TypeAlias = Callable[[Vehicle], float | None]


def distance_to_altitude(altitude: float) -> Remaining:
    """Return a function for the metres to an altitude above home."""

    def remaining(vehicle: Vehicle) -> float | None:
        height = height_above_home(vehicle)
        return None if height is None else abs(altitude - height)

    return remaining


def distance_to_place(latitude: float, longitude: float) -> Remaining:
    """Return a function for the metres over ground to a place."""

    def remaining(vehicle: Vehicle) -> float | None:
        position = vehicle.position
        if position is None:
            return None
        return distance(position.latitude, position.longitude, latitude, longitude)

    return remaining


def distance_to_home(vehicle: Vehicle) -> float | None:
    """Return the metres over ground to the home of a vehicle."""
    home = vehicle.home
    return None if home is None else distance_to_place(home.latitude, home.longitude)(vehicle)


def height_above_home(vehicle: Vehicle) -> float | None:
    """Return the height of a vehicle in metres above home; None if it has none, such as a rover."""
    position = vehicle.position
    if position is None or not vehicle.vehicle_type.has_altitude:
        return None
    return position.relative_altitude


def flight_progress(vehicle: Vehicle, title: str, remaining: Remaining | None = None) -> LiveLine:
    """Return the line with height, remaining distance and mode of a vehicle, as a context."""
    return LiveLine(lambda: progress_text(vehicle, title, remaining))


def progress_text(vehicle: Vehicle, title: str, remaining: Remaining | None = None) -> str:
    """Return the progress line."""
    parts = []
    height = height_above_home(vehicle)
    if height is not None:
        parts.append(f"{height:.1f} m high")
    to_go = None if remaining is None else remaining(vehicle)
    if to_go is not None:
        parts.append(f"{to_go:.0f} m to go")
    if mode := vehicle.mode:
        parts.append(mode)
    return f"{title}: {', '.join(parts) or 'no telemetry'}"
