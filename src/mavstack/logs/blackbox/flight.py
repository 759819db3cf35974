"""Decoding of a flight: its frames one after the other, over damaged parts too.

The rules are those of Betaflight's own decoder. Frames have no checksum and no length: a frame is complete
if another one, or the end, follows it directly; otherwise the search continues one byte behind its beginning.
P frames hold differences, so that after damage all are dropped up to the next I frame. A main frame whose
time or loop iteration goes back, or jumps by 10 s or 5000 iterations, is dropped as well; but where the
decoder would then drop the rest of the flight, the second of two I frames that fit each other is accepted.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from struct import Struct
from struct import error as struct_error
from typing import TYPE_CHECKING, Final

from mavstack.logs.blackbox.events import LOG_END, RESUME, read_event
from mavstack.logs.blackbox.frames import FrameReader, UnsupportedFieldError
from mavstack.logs.blackbox.header import MARKERS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.logs.blackbox.events import Event
    from mavstack.logs.blackbox.header import FlightHeader

_MAX_FRAME: Final = 256
_MAX_TIME_JUMP: Final = 10_000_000
_MAX_ITERATION_JUMP: Final = 5000
_WRAP: Final = 1 << 32
_INTRA, _INTER, _SLOW, _GPS, _HOME, _EVENT = b"IPSGHE"
_PADDING: Final = b"\x00\xff"
#: Placeholder for the time of rows before the first main frame.
UNKNOWN_TIME: Final = -1


class Rows:
    """Rows of a table.

    Args:
        width: Number of values in a row.

    Attributes:
        values: The values of all rows as 64-bit integers, one row after the other.
        times: Time of each row in microseconds since boot.
        positions: Position of each frame in the flight.
    """

    def __init__(self, width: int) -> None:
        self.values = bytearray()
        self.times: array[int] = array("q")
        self.positions: array[int] = array("q")
        self._pack = Struct(f"={width}q").pack

    def add(self, values: Sequence[int], time: int, position: int) -> bool:
        """Add a row, and return whether its values are numbers of 64 bits."""
        try:
            self.values += self._pack(*values)
        except struct_error:
            return False
        self.times.append(time)
        self.positions.append(position)
        return True


@dataclass(slots=True)
class FlightDamage:
    """Counts of what was not read: bytes outside of frames, and frames.

    Attributes:
        bad_bytes: Bytes outside of frames.
        corrupt: Frames that are not followed by another one.
        out_of_sequence: Main frames without the frames that they refer to, or with impossible times.
        without_home: Positions before the home position to which they refer.
    """

    bad_bytes: int = 0
    corrupt: int = 0
    out_of_sequence: int = 0
    without_home: int = 0


class FlightDecoder:
    """Decodes the frames of a flight.

    Args:
        data: The bytes of the flight.
        header: Its header.

    Attributes:
        main: Rows of I and P frames.
        slow: Rows of S frames.
        gps: Rows of G frames.
        home: Rows of H frames.
        events: The events with the time and the position of each.
        damage: What was not read.
        is_complete: True if the flight ends with its last event.

    Raises:
        UnsupportedFieldError: The header lacks main frames, or has unknown encodings or predictors.
    """

    def __init__(self, data: bytes, header: FlightHeader) -> None:
        self._data = data
        self._readers = {
            ord(letter): FrameReader(definition, header) for letter, definition in header.frames.items()
        }
        names = header.frames["I"].names if {"I", "P"} <= header.frames.keys() else ()
        if not {"loopIteration", "time"} <= set(names) or header.frames["P"].names != names:
            raise UnsupportedFieldError("no definition of main frames")
        self._nothing = [0] * len(names)
        self._iteration, self._time = names.index("loopIteration"), names.index("time")
        gps = header.frames.get("G")
        self._gps_time = gps.names.index("time") if gps is not None and "time" in gps.names else None
        self._skipped_after = _SkippedIterations(header)
        self.main, self.slow, self.gps, self.home = (
            Rows(len(header.frames[letter].names) if letter in header.frames else 0) for letter in "ISGH"
        )
        self.events: list[tuple[Event, int, int]] = []
        self.damage = FlightDamage()
        self.is_complete = False
        self._previous: list[int] | None = None
        self._before: list[int] | None = None
        self._last: tuple[int, int] | None = None
        self._rejected: tuple[int, int] | None = None
        self._home: list[int] | None = None
        self._rollover = 0
        self._end = len(data)
        self._decode(header.end)

    @property
    def _last_time(self) -> int:
        return UNKNOWN_TIME if self._last is None else self._last[1]

    def _decode(self, position: int) -> None:
        data, damage = self._data, self.damage
        while position < self._end:
            marker = data[position]
            if marker in (_INTRA, _INTER):
                end = self._main_frame(marker, position)
            elif marker not in MARKERS or (marker != _EVENT and marker not in self._readers):
                self._lose_sequence()
                damage.bad_bytes += 1
                position += 1
                continue
            else:
                end = self._frame(marker, position)
            if end is None:
                self._lose_sequence()
                damage.corrupt += 1
                damage.bad_bytes += 1
                position += 1
            else:
                position = end
        rest = data[self._end :]
        damage.bad_bytes += len(rest) - sum(rest.count(byte) for byte in (_PADDING[:1], _PADDING[1:]))

    def _is_complete_frame(self, position: int, end: int) -> bool:
        """Return whether a frame is followed by another frame or by the end."""
        size = len(self._data)
        return end - position <= _MAX_FRAME and (end == size or (end < size and self._data[end] in MARKERS))

    def _frame(self, marker: int, position: int) -> int | None:
        """Read another frame, and return the position behind it; None if it is not complete."""
        event, values = None, None
        try:
            if marker == _EVENT:
                event, end = read_event(self._data, position + 1)
            else:
                values, end = self._readers[marker].read(self._data, position + 1)
        except IndexError:
            return None
        is_last = event is not None and event.kind == LOG_END and end - position <= _MAX_FRAME
        if not is_last and not self._is_complete_frame(position, end):
            return None
        if values is None:
            self._event(event, position, end)
        else:
            self._other_frame(marker, values, position)
        return end

    def _lose_sequence(self) -> None:
        self._previous = self._before = None

    # main frames

    def _main_frame(self, marker: int, position: int) -> int | None:
        """Read a main frame, and return the position behind it; None if it is not complete."""
        previous, last = self._previous, self._last
        before, skipped = previous, 0
        if marker == _INTER:
            before = self._before
            if last is not None:
                skipped = self._skipped_after(last[0])
        try:
            values, end = self._readers[marker].decode(
                self._data, position + 1, previous or self._nothing, before or self._nothing, skipped
            )
        except IndexError:
            return None
        if not self._is_complete_frame(position, end):
            return None
        if marker == _INTER and previous is None:
            self.damage.out_of_sequence += 1
            return end
        time = values[self._time] = self._unwrapped(values[self._time])
        moment = values[self._iteration] % _WRAP, time
        follows = last is None or _follows(moment, last)
        if not (follows or self._restarts(marker, moment)) or not self.main.add(values, time, position):
            self.damage.out_of_sequence += 1
            self._lose_sequence()
            return end
        self._last, self._rejected = moment, None
        self._before = values if marker == _INTRA else previous
        self._previous = values
        return end

    def _restarts(self, marker: int, moment: tuple[int, int]) -> bool:
        """Return whether a frame that does not fit the last one fits the I frame that was dropped before."""
        if marker == _INTRA:
            rejected, self._rejected = self._rejected, moment
            return rejected is not None and _follows(moment, rejected)
        return False

    def _unwrapped(self, time: int) -> int:
        """Return a time of 32 bits as microseconds since boot."""
        time %= _WRAP
        if self._last is not None:
            last = self._last[1] % _WRAP
            if time < last and (time - last) % _WRAP < _MAX_TIME_JUMP:
                self._rollover += _WRAP
        return time + self._rollover

    # other frames

    def _other_frame(self, marker: int, values: list[int], position: int) -> None:
        reader = self._readers[marker]
        if marker == _GPS:
            self._gps_frame(reader, values, position)
            return
        if marker == _HOME:
            self._home = values
        rows = self.home if marker == _HOME else self.slow
        if not rows.add(values, self._last_time, position):
            self.damage.corrupt += 1

    def _gps_frame(self, reader: FrameReader, values: list[int], position: int) -> None:
        if reader.needs_home and (self._home is None or len(self._home) < 2):
            self.damage.without_home += 1
            return
        reader.add_position(values, self._home or (0, 0), max(self._last_time, 0))
        time = self._last_time
        if self._gps_time is not None:
            time = values[self._gps_time] = self._unwrapped(values[self._gps_time])
        if not self.gps.add(values, time, position):
            self.damage.corrupt += 1

    def _event(self, event: Event | None, position: int, end: int) -> None:
        if event is None:
            self.damage.corrupt += 1
            self.damage.bad_bytes += end - position
            return
        if event.kind == LOG_END:
            self.is_complete, self._end = True, end
        time = self._last_time
        if event.time is not None:
            time = event.time + self._rollover
        if event.kind == RESUME:
            self._last = int(event.value), time
        self.events.append((event, time, position))


class _SkippedIterations:
    """The number of loop iterations after one that are not logged, as the settings of the log rate say.

    Args:
        header: The header of the flight.
    """

    def __init__(self, header: FlightHeader) -> None:
        self._interval = max(header.number("I interval", 32), 1)
        numerator, _, denominator = header.values.get("P interval", "1/1").partition("/")
        # A single number N means 1/N: every Nth iteration is logged.
        fraction = (numerator, denominator) if denominator else ("1", numerator)
        valid = all(text.strip().isdecimal() and int(text) for text in fraction)
        self._numerator, self._denominator = (int(fraction[0]), int(fraction[1])) if valid else (1, 1)
        self._numerator = min(self._numerator, self._denominator)
        self._known: dict[int, int] = {}

    def __call__(self, iteration: int) -> int:
        """Return the number of iterations between one and the next one that is logged."""
        phase = iteration % self._interval
        if phase not in self._known:
            index = phase + 1
            while not self._is_logged(index % self._interval) and index <= phase + self._interval:
                index += 1
            self._known[phase] = index - phase - 1
        return self._known[phase]

    def _is_logged(self, phase: int) -> bool:
        return (phase + self._numerator - 1) % self._denominator < self._numerator


def _follows(moment: tuple[int, int], last: tuple[int, int]) -> bool:
    """Return whether loop iteration and time can belong to the frame after another frame."""
    iterations, time = moment[0] - last[0], moment[1] - last[1]
    return 0 <= iterations < _MAX_ITERATION_JUMP and 0 <= time < _MAX_TIME_JUMP
