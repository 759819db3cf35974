"""Frames of RTCM 3: correction data of a reference station, in a stream of bytes.

    0xD3 · 6 reserved bits, 10 bits length · payload · CRC-24Q over all that precedes it

The first 12 bits of a payload are the message number. Only the bits that tell epochs apart are decoded: a
receiver decodes the rest. After damage the framer resumes one byte behind the false preamble.
"""

from __future__ import annotations

from typing import Final, NamedTuple

PREAMBLE: Final = 0xD3
#: Size of the header, of the checksum and of the longest payload, in bytes.
HEADER_SIZE: Final = 3
CRC_SIZE: Final = 3
MAX_PAYLOAD: Final = 1023
#: Message numbers of the position and the description of the reference station, which change rarely.
STATION_NUMBERS: Final = frozenset({1005, 1006, 1007, 1008, 1013, 1029, 1033, 1230})
#: Message numbers with the position of the reference station.
POSITION_NUMBERS: Final = frozenset({1005, 1006})

_POLYNOMIAL: Final = 0x1864CFB
_MASK: Final = 0xFFFFFF
_FIRST_MSM, _LAST_MSM = 1071, 1137
#: The beginning of a multiple signal message: number (12 bits), station (12) and epoch (30), in whole bytes.
_EPOCH_BYTES: Final = 7
_EPOCH_SHIFT: Final = 2
_EPOCH_MASK: Final = (1 << 30) - 1


def _crc_table() -> tuple[int, ...]:
    table = []
    for byte in range(256):
        crc = byte << 16
        for _ in range(8):
            crc <<= 1
            if crc & 0x1000000:
                crc ^= _POLYNOMIAL
        table.append(crc)
    return tuple(table)


_TABLE: Final = _crc_table()


def crc24q(data: bytes) -> int:
    """Return the CRC-24Q of bytes (polynomial 0x1864CFB, start 0)."""
    crc = 0
    for byte in data:
        crc = (crc << 8 & _MASK) ^ _TABLE[crc >> 16 ^ byte]
    return crc


class RtcmFrame(NamedTuple):
    """A frame whose checksum is right.

    Attributes:
        number: The message number, such as 1005 or 1074; 0 if the payload has none.
        data: The whole frame, as it is sent to a receiver.
    """

    number: int
    data: bytes

    @classmethod
    def of(cls, payload: bytes) -> RtcmFrame:
        """Return the frame of a payload of at most 1023 bytes."""
        body = bytes((PREAMBLE, len(payload) >> 8 & 0x03, len(payload) & 0xFF)) + payload
        return cls._of_data(body + crc24q(body).to_bytes(CRC_SIZE, "big"))

    @classmethod
    def _of_data(cls, data: bytes) -> RtcmFrame:
        payload = data[HEADER_SIZE:-CRC_SIZE]
        return cls(int.from_bytes(payload[:2], "big") >> 4 if len(payload) > 1 else 0, data)

    @property
    def is_observation(self) -> bool:
        """True for observations of satellites: MSM, and the older 1001 to 1004 and 1009 to 1012."""
        return self.is_msm or 1001 <= self.number <= 1004 or 1009 <= self.number <= 1012

    @property
    def is_msm(self) -> bool:
        """True for a multiple signal message."""
        return _FIRST_MSM <= self.number <= _LAST_MSM and 1 <= self.number % 10 <= 7

    @property
    def epoch(self) -> int | None:
        """The time of the observation, as the constellation counts it; None if the message has none."""
        payload = self.data[HEADER_SIZE:-CRC_SIZE]
        if not self.is_msm or len(payload) < _EPOCH_BYTES:
            return None
        return int.from_bytes(payload[:_EPOCH_BYTES], "big") >> _EPOCH_SHIFT & _EPOCH_MASK


class RtcmFramer:
    """Finds frames in a stream of bytes."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        #: Number of bytes outside of frames, and number of false or damaged frames.
        self.bad_bytes = self.bad_frames = 0

    def feed(self, data: bytes) -> list[RtcmFrame]:
        """Return the frames that the bytes complete."""
        self._buffer += data
        frames: list[RtcmFrame] = []
        while (frame := self._next()) is not None:
            frames.append(frame)
        return frames

    def reset(self) -> None:
        """Drop an incomplete frame, as after the loss of a connection."""
        self.bad_bytes += len(self._buffer)
        self._buffer.clear()

    def _next(self) -> RtcmFrame | None:
        buffer = self._buffer
        while True:
            self._skip_to_preamble()
            if len(buffer) < HEADER_SIZE:
                return None
            size = HEADER_SIZE + ((buffer[1] & 0x03) << 8 | buffer[2]) + CRC_SIZE
            reserved = buffer[1] & 0xFC
            if not reserved and len(buffer) < size:
                return None
            candidate = bytes(buffer[:size])
            if not reserved and crc24q(candidate[:-CRC_SIZE]) == int.from_bytes(candidate[-CRC_SIZE:], "big"):
                del buffer[:size]
                return RtcmFrame._of_data(candidate)  # noqa: SLF001 (of this module)
            self.bad_frames += not reserved
            self.bad_bytes += 1
            del buffer[0]

    def _skip_to_preamble(self) -> None:
        start = self._buffer.find(PREAMBLE)
        skipped = len(self._buffer) if start < 0 else start
        if skipped:
            self.bad_bytes += skipped
            del self._buffer[:skipped]
