"""The ground station's question whether a vehicle has the terrain of a position (TERRAIN_CHECK).

TERRAIN_CHECK has no target: it is routed to one vehicle, and the TERRAIN_REPORT of that vehicle with the same
position is the answer. A vehicle that lacks the terrain requests it from then on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, RemoteTimeout
from mavstack.services.addressing import message_ids
from mavstack.services.arguments import check_number
from mavstack.services.operation import Client, Operation
from mavstack.services.procedure import Procedure
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence
    from typing import Any

    from mavstack.services.terrain.client import Position
    from mavstack.wire import Packet

#: Attempts without an answer after which a check fails.
ATTEMPTS: Final = 6
#: Seconds between two checks of a position whose terrain is missing.
CHECK_INTERVAL: Final = 1.0
#: Seconds without a new tile after which waiting for terrain fails.
STALL_TIMEOUT: Final = 60.0
_NOTHING_ARRIVES: Final = f"no tile arrived for {STALL_TIMEOUT:g} s; does a ground station serve terrain?"


@dataclass(frozen=True, slots=True)
class TerrainState:
    """The terrain that a vehicle has at a position (TERRAIN_REPORT).

    Attributes:
        latitude: Degrees.
        longitude: Degrees.
        spacing: Metres between two points of its grid; 0 if it lacks the terrain of the position.
        terrain_height: Height of the terrain in metres above mean sea level; None if it is lacking.
        current_height: Height of the vehicle in metres above that terrain; None if it is lacking.
        pending: Tiles of 4 x 4 points that the vehicle is waiting for, of all positions.
        loaded: Tiles that it has.
    """

    latitude: float
    longitude: float
    spacing: int
    terrain_height: float | None
    current_height: float | None
    pending: int
    loaded: int

    @property
    def is_known(self) -> bool:
        """True if the vehicle has the terrain of the position."""
        return self.spacing > 0

    @classmethod
    def of(cls, report: common.TerrainReport) -> TerrainState:
        """Return the state that a message reports."""
        known = report.spacing > 0
        return cls(
            latitude=report.lat / 1e7,
            longitude=report.lon / 1e7,
            spacing=report.spacing,
            terrain_height=report.terrain_height if known else None,
            current_height=report.current_height if known else None,
            pending=report.pending,
            loaded=report.loaded,
        )


class CheckTerrain(Operation[TerrainState]):
    """One check of a position, repeated until it is answered."""

    handles = message_ids(common.TerrainReport)

    def __init__(self, latitude: float, longitude: float, *, timeout: float | None = None) -> None:
        super().__init__("checking the terrain of", timeout=timeout, idle_timeout=30.0)
        self._place = _checked(latitude, longitude)
        self._round_trip = RoundTrip(initial=1.0, maximum=4.0)

    def start(self, now: float) -> None:
        self.attempts += 1
        self.timer = now + self._round_trip.timeout(self.attempts)
        self.send(common.TerrainCheck(*self._place))

    def handle_timeout(self, now: float) -> None:
        if self.attempts >= ATTEMPTS:
            self.time_out(now)
        else:
            self.start(now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.TerrainReport(lat=latitude, lon=longitude) as report:
                if (latitude, longitude) == self._place:
                    self.finish(TerrainState.of(report))


class _Pause(Operation[None]):
    """A pause between two checks."""

    def __init__(self) -> None:
        super().__init__("waiting for terrain data on")

    def start(self, now: float) -> None:
        self.timer = now + CHECK_INTERVAL

    def handle_timeout(self, now: float) -> None:
        self.finish(None)


class WaitForTerrain(Procedure[None]):
    """Checks positions again and again until the vehicle has the terrain of all of them."""

    def __init__(self, positions: Sequence[Position], *, timeout: float | None = None) -> None:
        super().__init__("waiting for terrain data on", timeout=timeout)
        self._positions = [(latitude, longitude) for latitude, longitude in positions]
        for position in self._positions:
            _checked(*position)

    def steps(self) -> Generator[Operation[Any], Any, None]:
        tiles, changed_at = (0, 0), self.now
        for number, position in enumerate(self._positions):
            while not (state := (yield CheckTerrain(*position))).is_known:
                if (state.pending, state.loaded) != tiles:
                    tiles, changed_at = (state.pending, state.loaded), self.now
                elif self.now - changed_at >= STALL_TIMEOUT:
                    raise RemoteTimeout(self.description, str(self.target), answer=_NOTHING_ARRIVES)
                yield _Pause()
            self.report_progress(self.now, number + 1, len(self._positions))


class TerrainCheckClient(Client):
    """Checks the terrain of one vehicle."""

    def check(
        self, latitude: float, longitude: float, now: float, *, timeout: float | None = None
    ) -> CheckTerrain:
        """Ask for the terrain of a position.

        Args:
            latitude: Degrees.
            longitude: Degrees.
            now: The time, Unix seconds.
            timeout: Seconds for the whole operation; None: until retries are exhausted.

        Returns:
            The operation, whose result is a `TerrainState`.

        Raises:
            InvalidTypeError: The position is not two numbers.
            InvalidArgumentError: The position is not on Earth.
        """
        return self.begin(CheckTerrain(latitude, longitude, timeout=timeout), now)

    def wait_until_loaded(
        self, positions: Sequence[Position], now: float, *, timeout: float | None = None
    ) -> WaitForTerrain:
        """Wait until the vehicle has the terrain of all positions.

        Args:
            positions: Latitudes and longitudes in degrees.
            now: The time, Unix seconds.
            timeout: Seconds for the whole operation; None: until no tile arrived for `STALL_TIMEOUT` seconds.

        Returns:
            The operation.

        Raises:
            InvalidTypeError: A position is not two numbers.
            InvalidArgumentError: A position is not on Earth.
        """
        return self.begin(WaitForTerrain(positions, timeout=timeout), now)


def _checked(latitude: float, longitude: float) -> tuple[int, int]:
    """Return a position in 1e-7 degrees; raises if it is not on Earth."""
    check_number("latitude", latitude)
    check_number("longitude", longitude)
    if abs(latitude) > 90 or abs(longitude) > 180:
        raise InvalidArgumentError(f"a position must be on Earth, got {latitude}, {longitude}")
    return round(latitude * 1e7), round(longitude * 1e7)
