"""Progress of an action in flight: one line on a terminal, nothing in a pipe."""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING

from mavstack.cli.common.output import echo_progress
from mavstack.geodesy import distance

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self, TypeAlias

    from mavstack.vehicle import Vehicle

    #: Returns the remaining distance in metres; None if it is not known.
    Remaining: TypeAlias = Callable[[Vehicle], float | None]

#: Seconds before the first progress line; a shorter action prints no progress.
SHOW_DELAY = 0.5
SHOW_INTERVAL = 0.25


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


class FlightProgress:
    """Shows height, remaining distance and mode on stderr while a block runs."""

    def __init__(self, vehicle: Vehicle, title: str, remaining: Remaining | None = None) -> None:
        self._vehicle = vehicle
        self._title = title
        self._remaining = remaining
        self._shown = False
        self._task: asyncio.Task[None] | None = None

    def text(self) -> str:
        """Return the progress line."""
        parts = []
        height = height_above_home(self._vehicle)
        if height is not None:
            parts.append(f"{height:.1f} m high")
        remaining = None if self._remaining is None else self._remaining(self._vehicle)
        if remaining is not None:
            parts.append(f"{remaining:.0f} m to go")
        if mode := self._vehicle.mode:
            parts.append(mode)
        return f"{self._title}: {', '.join(parts) or 'no telemetry'}"

    async def _show(self) -> None:
        await asyncio.sleep(SHOW_DELAY)
        while True:
            self._shown = True
            echo_progress(self.text())
            await asyncio.sleep(SHOW_INTERVAL)

    async def __aenter__(self) -> Self:
        if sys.stderr.isatty():
            self._task = asyncio.get_running_loop().create_task(self._show())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        if self._shown:
            echo_progress("")
