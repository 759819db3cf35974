"""The fragments of GPS_RTCM_DATA.

    flags: bit 0 fragmented · bits 1 and 2 number of the fragment · bits 3 to 7 sequence number

Data of up to 180 bytes is one message that is not fragmented. Longer data has up to four fragments of 180
bytes. A receiver considers data complete with its fourth fragment or with one of less than 180 bytes, so
data of 360 or 540 bytes ends with an empty fragment. More than 720 bytes cannot be sent. Sources: PX4,
MavlinkReceiver and its assembler of fragments; ArduPilot, AP_GPS::handle_gps_rtcm_fragment. The guide has no
page on it.
"""

from __future__ import annotations

from typing import Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

#: The largest number of bytes of a fragment, of fragments of a frame, and of bytes of a frame.
FRAGMENT_SIZE: Final = 180
MAX_FRAGMENTS: Final = 4
MAX_FRAME: Final = FRAGMENT_SIZE * MAX_FRAGMENTS
_SEQUENCES: Final = 32


def fragment(data: bytes, sequence: int) -> list[common.GpsRtcmData]:
    """Return the messages that carry a frame.

    Args:
        data: The frame, 1 to 720 bytes.
        sequence: The sequence number of the frame; its last five bits count.

    Returns:
        One to four messages.

    Raises:
        InvalidArgumentError: The frame is empty or too long.
    """
    if not 0 < len(data) <= MAX_FRAME:
        raise InvalidArgumentError(f"a frame must have 1 to {MAX_FRAME} bytes, got {len(data)}")
    flags = (sequence % _SEQUENCES) << 3
    if len(data) <= FRAGMENT_SIZE:
        return [common.GpsRtcmData(flags=flags, len=len(data), data=data)]
    count = min(len(data) // FRAGMENT_SIZE + 1, MAX_FRAGMENTS)
    parts = [data[FRAGMENT_SIZE * index : FRAGMENT_SIZE * (index + 1)] for index in range(count)]
    return [
        common.GpsRtcmData(flags=flags | index << 1 | 1, len=len(part), data=part)
        for index, part in enumerate(parts)
    ]


class FrameAssembler:
    """Joins the fragments of one sender, as autopilots do: a lost fragment loses its frame."""

    def __init__(self) -> None:
        self._parts: dict[int, bytes] = {}
        self._sequence = -1
        #: The number of frames that were not completed.
        self.lost = 0

    def add(self, message: common.GpsRtcmData) -> bytes | None:
        """Add a message; return the frame that it completes, or None."""
        data = bytes(message.data[: min(message.len, FRAGMENT_SIZE)])
        sequence, number = message.flags >> 3, message.flags >> 1 & 3
        if not message.flags & 1:
            self._drop()
            return data
        if sequence != self._sequence or number in self._parts:
            self._drop()
        self._sequence, self._parts[number] = sequence, data
        return self._joined()

    def _joined(self) -> bytes | None:
        """Return the frame if all its fragments are there."""
        last = next((number for number in range(MAX_FRAGMENTS) if self._is_last(number)), None)
        if last is None or any(number not in self._parts for number in range(last + 1)):
            return None
        frame = b"".join(self._parts[number] for number in range(last + 1))
        self._parts.clear()
        self._sequence = -1
        return frame

    def _is_last(self, number: int) -> bool:
        part = self._parts.get(number)
        return part is not None and (len(part) < FRAGMENT_SIZE or number == MAX_FRAGMENTS - 1)

    def _drop(self) -> None:
        self.lost += bool(self._parts)
        self._parts.clear()
        self._sequence = -1
