"""A streaming parser of MSP frames, as a table of states.

A serial line carries frames, the text of the command line interface (CLI), and noise. The parser looks for
`$`; each further byte moves it to the next state of `HEADER`, or shows that no frame began there. Then, and
when a checksum is wrong, the parser continues with the byte after that `$`, so that a damaged size never
costs a sound frame behind it. The result depends on the bytes alone, not on how they are cut into chunks.

Bytes that belong to no frame are kept as text, `MAX_TEXT` at most, of which the oldest is dropped. In the
state CLI all bytes are text.

A frame whose size promises more bytes than come makes the parser wait; `resynchronize` gives that frame up,
which a client does when its request times out.
"""

from __future__ import annotations

from enum import Enum, auto
from typing import Final

from mavstack.msp.frame import (
    JUMBO_SIZE,
    MAX_PAYLOAD,
    V2_HEADER_SIZE,
    V2_OVER_V1_COMMAND,
    Direction,
    Frame,
    FrameVersion,
    crc8,
    xor8,
)

#: Maximum number of bytes of text that are kept until `take_text` is called.
MAX_TEXT: Final = 64 << 10
_START: Final = ord("$")
_V1: Final = b"$M"
#: Number of bytes of `$M<`.
_PREFIX: Final = 3


class State(Enum):
    """The byte that the parser expects next."""

    IDLE = auto()
    PROTOCOL = auto()
    DIRECTION_V1 = auto()
    LENGTH_V1 = auto()
    COMMAND_V1 = auto()
    LENGTH_JUMBO_LOW = auto()
    LENGTH_JUMBO_HIGH = auto()
    PAYLOAD_V1 = auto()
    CHECKSUM_V1 = auto()
    PAYLOAD_V2_OVER_V1 = auto()
    DIRECTION_V2 = auto()
    FLAGS_V2 = auto()
    COMMAND_V2_LOW = auto()
    COMMAND_V2_HIGH = auto()
    LENGTH_V2_LOW = auto()
    LENGTH_V2_HIGH = auto()
    PAYLOAD_V2 = auto()
    CHECKSUM_V2 = auto()
    CLI = auto()


_ANY: Final = range(256)
_DIRECTIONS: Final = {ord(direction): direction for direction in Direction}

#: For each state of the header: the next state for each byte that is accepted.
HEADER: Final[dict[State, dict[int, State]]] = {
    State.PROTOCOL: {ord("M"): State.DIRECTION_V1, ord("X"): State.DIRECTION_V2},
    State.DIRECTION_V1: dict.fromkeys(_DIRECTIONS, State.LENGTH_V1),
    State.LENGTH_V1: dict.fromkeys(_ANY, State.COMMAND_V1),
    State.COMMAND_V1: dict.fromkeys(_ANY, State.PAYLOAD_V1),  # or LENGTH_JUMBO_LOW, depending on the length
    State.LENGTH_JUMBO_LOW: dict.fromkeys(_ANY, State.LENGTH_JUMBO_HIGH),
    State.LENGTH_JUMBO_HIGH: dict.fromkeys(_ANY, State.PAYLOAD_V1),
    State.DIRECTION_V2: dict.fromkeys(_DIRECTIONS, State.FLAGS_V2),
    State.FLAGS_V2: dict.fromkeys(_ANY, State.COMMAND_V2_LOW),
    State.COMMAND_V2_LOW: dict.fromkeys(_ANY, State.COMMAND_V2_HIGH),
    State.COMMAND_V2_HIGH: dict.fromkeys(_ANY, State.LENGTH_V2_LOW),
    State.LENGTH_V2_LOW: dict.fromkeys(_ANY, State.LENGTH_V2_HIGH),
    State.LENGTH_V2_HIGH: dict.fromkeys(_ANY, State.PAYLOAD_V2),
}


class FrameParser:
    """Find the frames in a stream of bytes; bad input is counted, never raised.

    Attributes:
        bad_checksums: Frames with a wrong checksum.
        oversized: Frames that announced more than 4,096 bytes.
        skipped_bytes: Bytes that belonged to no frame, text included.
    """

    def __init__(self) -> None:
        self.bad_checksums = 0
        self.oversized = 0
        self.skipped_bytes = 0
        self._state = State.IDLE
        self._buffer = bytearray()  # begins with the `$` of the current frame
        self._position = 0  # index of the next byte in the buffer
        self._payload = 0  # index of the payload in the buffer
        self._size = 0  # size of the payload
        self._text = bytearray()

    @property
    def state(self) -> State:
        """The byte that is expected next."""
        return self._state

    def feed(self, data: bytes | bytearray | memoryview) -> list[Frame]:
        """Parse bytes, in chunks of any size.

        Args:
            data: The next bytes of the stream.

        Returns:
            The frames that are complete now, oldest first.
        """
        if self._state is State.CLI:
            self._add_text(bytes(data))
            return []
        self._buffer += data
        return self._run()

    def resynchronize(self) -> list[Frame]:
        """Give up the frame that has begun and is not complete.

        Returns:
            The frames that are complete behind its first byte.
        """
        frames: list[Frame] = []
        while self._state not in (State.IDLE, State.CLI):
            self._reject()
            frames += self._run()
        return frames

    def enter_cli(self) -> None:
        """Take all further bytes as text, until `leave_cli`."""
        self._add_text(bytes(self._buffer))
        self._buffer.clear()
        self._position, self._state = 0, State.CLI

    def leave_cli(self) -> None:
        """Look for frames again."""
        if self._state is State.CLI:
            self._state = State.IDLE

    def take_text(self) -> bytes:
        """Return the bytes that belonged to no frame since the last call."""
        text = bytes(self._text)
        self._text.clear()
        return text

    def _run(self) -> list[Frame]:
        frames: list[Frame] = []
        buffer = self._buffer
        while self._position < len(buffer):
            if self._state is State.IDLE:
                if (whole := self._read_whole_frame()) is not None:
                    frames.append(whole)
                else:
                    self._find_start()
            elif (allowed := HEADER.get(self._state)) is not None:
                self._read_header(allowed.get(buffer[self._position]))
            elif self._state in (State.PAYLOAD_V1, State.PAYLOAD_V2):
                if not self._read_payload():
                    break
            elif (frame := self._read_checksum()) is not None:
                frames.append(frame)
        return frames

    def _read_whole_frame(self) -> Frame | None:
        """Return the v1 frame that the buffer is, as with most replies; otherwise leave it to the states."""
        buffer = self._buffer
        size = len(buffer) - _PREFIX - 3
        if size < 0 or size != buffer[_PREFIX] or buffer[:2] != _V1 or buffer[2] not in _DIRECTIONS:
            return None
        if size == JUMBO_SIZE or buffer[_PREFIX + 1] == V2_OVER_V1_COMMAND or xor8(buffer[_PREFIX:]):
            return None
        payload = bytes(buffer[_PREFIX + 2 : -1])
        frame = Frame(buffer[_PREFIX + 1], payload, _DIRECTIONS[buffer[2]])
        buffer.clear()
        return frame

    def _find_start(self) -> None:
        """Move text to its place, up to the next `$`, which begins the buffer then."""
        start = self._buffer.find(_START)
        text = bytes(self._buffer if start < 0 else self._buffer[:start])
        self._add_text(text)
        del self._buffer[: len(text)]
        if start >= 0:
            self._position, self._state = 1, State.PROTOCOL

    def _read_header(self, state: State | None) -> None:
        if state is None:
            self._reject()
            return
        self._position += 1
        if self._state is State.COMMAND_V1 and self._buffer[_PREFIX] == JUMBO_SIZE:
            state = State.LENGTH_JUMBO_LOW
        self._state = state
        if state in (State.PAYLOAD_V1, State.PAYLOAD_V2):
            self._begin_payload()

    def _begin_payload(self) -> None:
        is_short = self._position == _PREFIX + 2
        self._size = self._buffer[_PREFIX] if is_short else self._number(self._position - 2)
        self._payload = self._position
        if self._size > MAX_PAYLOAD + (V2_HEADER_SIZE + 1 if self._is_over_v1() else 0):
            self.oversized += 1
            self._reject()

    def _read_payload(self) -> bool:
        """Read the payload; False if bytes are missing."""
        if len(self._buffer) < self._payload + self._size + 1:
            return False  # wait for the checksum too, so that nothing is read twice
        self._position = self._payload + self._size
        self._state = State.CHECKSUM_V1 if self._state is State.PAYLOAD_V1 else State.CHECKSUM_V2
        return True

    def _read_checksum(self) -> Frame | None:
        """Return the frame that ends with this byte; None if its checksum is wrong."""
        body = self._buffer[_PREFIX : self._position]
        checksum = xor8 if self._state is State.CHECKSUM_V1 else crc8
        if checksum(body) != self._buffer[self._position]:
            frame = None
        elif self._state is State.CHECKSUM_V2:
            frame = self._v2_frame(_PREFIX, FrameVersion.V2)
        elif self._is_over_v1():
            self._state = State.PAYLOAD_V2_OVER_V1
            frame = self._read_v2_over_v1()
        else:
            frame = self._v1_frame()
        if frame is None:
            self.bad_checksums += 1
            self._reject()
        else:
            del self._buffer[: self._position + 1]
            self._position, self._state = 0, State.IDLE
        return frame

    def _v1_frame(self) -> Frame:
        version = FrameVersion.JUMBO if self._payload > _PREFIX + 2 else FrameVersion.V1
        payload = bytes(self._buffer[self._payload : self._position])
        return Frame(self._buffer[_PREFIX + 1], payload, self._direction(), version)

    def _v2_frame(self, start: int, version: FrameVersion) -> Frame:
        payload = bytes(
            self._buffer[start + V2_HEADER_SIZE : start + V2_HEADER_SIZE + self._number(start + 3)]
        )
        flags, command = self._buffer[start], self._number(start + 1)
        return Frame(command, payload, self._direction(), version, flags)

    def _read_v2_over_v1(self) -> Frame | None:
        start, end = self._payload, self._position
        if self._size <= V2_HEADER_SIZE or self._number(start + 3) != self._size - V2_HEADER_SIZE - 1:
            return None
        if crc8(self._buffer[start : end - 1]) != self._buffer[end - 1]:
            return None
        return self._v2_frame(start, FrameVersion.V2_OVER_V1)

    def _is_over_v1(self) -> bool:
        return self._buffer[1] == ord("M") and self._buffer[_PREFIX + 1] == V2_OVER_V1_COMMAND

    def _direction(self) -> Direction:
        return _DIRECTIONS[self._buffer[2]]

    def _number(self, position: int) -> int:
        return self._buffer[position] | self._buffer[position + 1] << 8

    def _reject(self) -> None:
        """Make text of the `$` that begins no frame, and continue behind it."""
        self._add_text(bytes(self._buffer[:1]))
        del self._buffer[:1]
        self._position, self._state = 0, State.IDLE

    def _add_text(self, text: bytes) -> None:
        self.skipped_bytes += len(text)
        self._text += text
        del self._text[:-MAX_TEXT]
