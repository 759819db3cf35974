"""How an action gets on while a vehicle flies: one line on a terminal, nothing in a pipe."""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING

from mavstack.vehicle.geography import distance

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self, TypeAlias

    from mavstack.vehicle import Vehicle

    Left: TypeAlias = Callable[[Vehicle], float | None]

#: What comes quicker than this leaves no trace, in seconds.
PATIENCE = 0.5
INTERVAL = 0.25
_ERASE = "\r\x1b[K"


def to_altitude(altitude: float) -> Left:
    """Metres that are missing to an altitude above home."""

    def left(vehicle: Vehicle) -> float | None:
        height = height_of(vehicle)
        return None if height is None else abs(altitude - height)

    return left


def to_place(latitude: float, longitude: float) -> Left:
    """Metres along the ground to a place."""

    def left(vehicle: Vehicle) -> float | None:
        position = vehicle.position
        if position is None:
            return None
        return distance(position.latitude, position.longitude, latitude, longitude)

    return left


def to_home(vehicle: Vehicle) -> float | None:
    """Metres along the ground to its home."""
    home = vehicle.home
    return None if home is None else to_place(home.latitude, home.longitude)(vehicle)


def height_of(vehicle: Vehicle) -> float | None:
    """Metres above home."""
    position = vehicle.position
    return None if position is None else position.relative_altitude


class FlightProgress:
    """Tells on stderr, while a block lasts, how high the vehicle is, how far it has to go, in which mode."""

    def __init__(self, vehicle: Vehicle, what: str, left: Left | None = None) -> None:
        self._vehicle = vehicle
        self._what = what
        self._left = left
        self._shown = False
        self._task: asyncio.Task[None] | None = None

    def text(self) -> str:
        """The line."""
        parts = []
        height = height_of(self._vehicle)
        if height is not None:
            parts.append(f"{height:.1f} m high")
        left = None if self._left is None else self._left(self._vehicle)
        if left is not None:
            parts.append(f"{left:.0f} m to go")
        if mode := self._vehicle.mode:
            parts.append(mode)
        return f"{self._what}: {', '.join(parts) or 'nothing is heard of it'}"

    async def _tell(self) -> None:
        await asyncio.sleep(PATIENCE)
        while True:
            self._shown = True
            print(f"{_ERASE}{self.text()}", end="", file=sys.stderr, flush=True)
            await asyncio.sleep(INTERVAL)

    async def __aenter__(self) -> Self:
        if sys.stderr.isatty():
            self._task = asyncio.get_running_loop().create_task(self._tell())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        if self._shown:
            print(_ERASE, end="", file=sys.stderr, flush=True)
