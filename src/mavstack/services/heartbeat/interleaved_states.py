"""Positions and headings of one address that contradict each other at the same boot time.

All positions of one vehicle are on one path, whatever link brings them and however late: ordered by their
boot time, each one is near the one before. Those of two vehicles jump to and fro between two paths. A vehicle
whose estimate jumps changes its path once, and once more if it returns; so only `MIN_SWITCHES` are evidence.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import degrees, hypot, radians
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.dialects import common
from mavstack.geodesy import distance

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message

#: Seconds of boot time, and of reception time, over which states are compared.
WINDOW = 12.0
#: Seconds of boot time after the previous state within which a state that fits it is not compared with
#: others.
MAX_STEP = 1.5
MAX_STATES = 64
#: The number of switches between two paths that shows a conflict.
MIN_SWITCHES = 4
#: The largest number of paths; states on more paths are noise.
MAX_PATHS = 4
#: Uncertainty of a position in metres, and of a speed in m/s, when two positions are compared.
POSITION_TOLERANCE, SPEED_TOLERANCE = 20.0, 10.0
#: Uncertainty of a heading in degrees, and of a turn rate in degrees/s, when two headings are compared.
HEADING_TOLERANCE, RATE_TOLERANCE = 40.0, 60.0
#: Degrees of roll or pitch above which a heading has no meaning.
MAX_TILT = 45.0

State = TypeVar("State", bound="PositionState | HeadingState")


@dataclass(frozen=True, slots=True)
class PositionState:
    """A position of GLOBAL_POSITION_INT: degrees, and the horizontal speed in m/s."""

    time: float
    received_at: float
    latitude: float
    longitude: float
    speed: float

    @classmethod
    def of(cls, message: common.GlobalPositionInt, now: float) -> PositionState | None:
        """Return the state of a message; None without a position."""
        if not message.lat and not message.lon:
            return None
        speed = hypot(message.vx, message.vy) / 100
        return cls(message.time_boot_ms / 1000, now, message.lat / 1e7, message.lon / 1e7, speed)

    def fits(self, other: PositionState) -> bool:
        """Return whether one vehicle can have had both positions."""
        apart = distance(self.latitude, self.longitude, other.latitude, other.longitude)
        fastest = max(self.speed, other.speed) * 1.5 + SPEED_TOLERANCE
        return apart <= POSITION_TOLERANCE + fastest * abs(self.time - other.time)


@dataclass(frozen=True, slots=True)
class HeadingState:
    """A heading of ATTITUDE: degrees, and its rate in degrees per second."""

    time: float
    received_at: float
    heading: float
    rate: float

    @classmethod
    def of(cls, message: common.Attitude, now: float) -> HeadingState | None:
        """Return the state of a message; None if the vehicle is tilted far, or if there is no number."""
        tilt = max(abs(message.roll), abs(message.pitch))
        if not tilt < radians(MAX_TILT):
            return None
        return cls(message.time_boot_ms / 1000, now, degrees(message.yaw), degrees(abs(message.yawspeed)))

    def fits(self, other: HeadingState) -> bool:
        """Return whether one vehicle can have had both headings; NaN fits all."""
        turn = abs((self.heading - other.heading + 180) % 360 - 180)
        fastest = max(self.rate, other.rate) * 2 + RATE_TOLERANCE
        return not turn > HEADING_TOLERANCE + fastest * abs(self.time - other.time)


class _Path(Generic[State]):
    """The states of one kind, and whether they are on one path."""

    def __init__(self, fits: Callable[[State, State], bool]) -> None:
        self._fits = fits
        self._states: deque[State] = deque(maxlen=MAX_STATES)

    def add(self, state: State) -> bool:
        """Record a state; return whether the states switch between two paths."""
        states = self._states
        if states and not self._is_next(state):
            states.append(state)
            return self._count_switches(state) >= MIN_SWITCHES
        states.append(state)
        return False

    def clear(self) -> None:
        """Forget all states."""
        self._states.clear()

    def _is_next(self, state: State) -> bool:
        """Return whether a state continues the one that was received before: nearly all do."""
        last = self._states[-1]
        return 0 <= state.time - last.time <= MAX_STEP and self._fits(last, state)

    def _count_switches(self, newest: State) -> int:
        """Count how often the recent states switch between paths, in the order of their boot times."""
        recent = [
            each
            for each in self._states
            if newest.received_at - each.received_at <= WINDOW and abs(newest.time - each.time) <= WINDOW
        ]
        recent.sort(key=lambda each: each.time)
        paths: list[State] = []  # the last state of each path; the path of the previous state is at the end
        switches = 0
        for state in recent:
            found = next((path for path in reversed(paths) if self._fits(path, state)), None)
            switches += bool(paths) and found is not paths[-1]
            if found is not None:
                paths = [path for path in paths if path is not found]
            paths.append(state)
        return switches if len(paths) <= MAX_PATHS else 0


class InterleavedStates:
    """The positions and the headings of one address."""

    def __init__(self) -> None:
        self._positions: _Path[PositionState] = _Path(PositionState.fits)
        self._headings: _Path[HeadingState] = _Path(HeadingState.fits)

    def add(self, message: Message, now: float) -> str:
        """Record a message; return the name of the state that contradicts those before, or an empty text."""
        match message:
            case common.GlobalPositionInt() if position := PositionState.of(message, now):
                return "position" if self._positions.add(position) else ""
            case common.Attitude() if heading := HeadingState.of(message, now):
                return "heading" if self._headings.add(heading) else ""
        return ""

    def clear(self) -> None:
        """Forget all states: the boot time restarted."""
        self._positions.clear()
        self._headings.clear()
