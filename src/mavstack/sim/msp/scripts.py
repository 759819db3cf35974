"""Steps of automatic flight, as scripts: a `yield` waits for the next tick, a tenth of a second.

Positions are metres north, east and down in the local frame of the body's estimate; altitudes of callers
are up.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.sim.motion import Body

#: Seconds between two ticks of a script.
TICK: Final = 0.1
#: Altitude error in metres below which an altitude counts as reached.
ALTITUDE_TOLERANCE: Final = 0.7
#: The target of a landing is this many metres below the ground, so that the vehicle descends until touchdown.
_BELOW_GROUND: Final = 50.0


@dataclass(frozen=True, slots=True)
class LandingSpeeds:
    """Speeds of a landing in m/s, and the altitude below which it is slow, in metres."""

    fast: float = 2.0
    slow: float = 0.5
    slow_below: float = 5.0


def hold(body: Body) -> Iterator[None]:
    """Hold the present position, without end."""
    here = body.estimate
    body.go_to(here.north, here.east, here.down)
    while True:
        yield


def climb_to(body: Body, down: float, *, climb: float) -> Iterator[None]:
    """Climb or descend to an altitude over the present position; `down` in metres, `climb` in m/s."""
    here = body.estimate
    body.go_to(here.north, here.east, down, climb=climb, sink=climb, yaw=here.yaw)
    while abs(body.estimate.down - down) > ALTITUDE_TOLERANCE:
        yield


def fly_to(
    body: Body,
    place: tuple[float, float, float],
    *,
    speed: float,
    climb: float,
    radius: float,
    yaw: float | None = None,
    enforces_altitude: bool = False,
) -> Iterator[None]:
    """Fly to a place.

    Args:
        body: The body.
        place: Metres north, east and down.
        speed: Horizontal speed in m/s.
        climb: Climb and sink rate in m/s.
        radius: Metres from the place within which it counts as reached.
        yaw: Heading in radians; None to look along the way.
        enforces_altitude: Wait for the altitude too.
    """
    north, east, down = place
    body.go_to(north, east, down, speed=speed, climb=climb, sink=climb, yaw=yaw)
    while True:
        here = body.estimate
        is_near = hypot(here.north - north, here.east - east) <= radius
        if is_near and (not enforces_altitude or abs(here.down - down) <= ALTITUDE_TOLERANCE):
            return
        yield


def wait(seconds: float) -> Iterator[None]:
    """Wait, without a new demand; an infinite wait has no end."""
    if seconds == inf:
        while True:
            yield
    for _ in range(round(seconds / TICK)):
        yield


def land(body: Body, speeds: LandingSpeeds, place: tuple[float, float] | None = None) -> Iterator[None]:
    """Land, and end on the ground.

    Args:
        body: The body.
        speeds: The speeds.
        place: Metres north and east; None for the present position.
    """
    here = body.estimate
    north, east = place or (here.north, here.east)
    slow: bool | None = None
    while not body.on_ground:
        is_low = -body.estimate.down < speeds.slow_below
        if is_low is not slow:
            slow = is_low
            sink = speeds.slow if slow else speeds.fast
            body.go_to(north, east, _BELOW_GROUND, sink=sink, yaw=here.yaw)
        yield


class Script:
    """The script that is running, if any; it makes one tick every `TICK` seconds."""

    def __init__(self) -> None:
        self.name = ""
        self._steps: Iterator[None] | None = None
        self._due = 0.0

    def run(self, name: str, make: Callable[[], Iterator[None]], now: float) -> None:
        """Continue the script of a name, or start it in place of another.

        Args:
            name: The name; another one than before starts the script.
            make: Creates the script.
            now: The time in seconds.
        """
        if name != self.name:
            self.stop()
            self.name, self._steps, self._due = name, make(), now
        if self._steps is not None and now >= self._due:
            self._due += TICK
            if next(self._steps, self) is self:
                self._steps = None

    @property
    def is_done(self) -> bool:
        """True if the script has ended."""
        return bool(self.name) and self._steps is None

    def stop(self) -> None:
        """End the script."""
        self.name, self._steps = "", None
