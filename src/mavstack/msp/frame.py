"""Frames of MSP, the MultiWii Serial Protocol of Betaflight and iNav, in their four encodings.

A frame begins with `$`, a letter of its encoding and its direction: `<` to the flight controller, `>` from
it, `!` from it with an error. All numbers are little-endian.

```
v1           $M <  size  command  payload  xor
v1, jumbo    $M <  255   command  size16   payload  xor        a payload above 254 bytes
v2           $X <  flags  command16  size16  payload  crc8
v2 over v1   $M <  size  255  (flags command16 size16 payload crc8)  xor
```

`xor` covers the bytes from the size to the end of the payload. `crc8` is CRC-8/DVB-S2 of the bytes from the
flags to the end of the payload. Both accept one damaged frame in 256, so a value that matters is read again.
Source: `msp_serial.c` of both firmwares.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, StrEnum, auto
from functools import reduce
from operator import xor
from typing import Final

from mavstack.errors import InvalidArgumentError

#: Maximum size in bytes of a payload that is parsed or encoded.
MAX_PAYLOAD: Final = 4096
#: The largest command number of v1; larger numbers need v2.
MAX_V1_COMMAND: Final = 254
#: The command of a v1 frame whose payload is a v2 frame; also the size value that marks a jumbo frame.
V2_OVER_V1_COMMAND = JUMBO_SIZE = 255
#: Size in bytes of the v2 header, from the flags to the size.
V2_HEADER_SIZE: Final = 5
#: Flag of v2 with which the flight controller sends no reply.
NO_REPLY: Final = 1
_POLYNOMIAL: Final = 0xD5


class Direction(StrEnum):
    """The direction of a frame, as in its third byte."""

    REQUEST = "<"
    RESPONSE = ">"
    ERROR = "!"


class FrameVersion(Enum):
    """The encoding of a frame."""

    V1 = auto()
    JUMBO = auto()
    V2 = auto()
    V2_OVER_V1 = auto()


@dataclass(frozen=True, slots=True)
class Frame:
    """One frame.

    Attributes:
        command: Number of the command, 0 to 254 for v1 and to 65535 for v2.
        payload: The bytes of the message, 4,096 at most.
        direction: To the flight controller, from it, or from it with an error.
        version: The encoding; a payload above 254 bytes makes JUMBO of V1.
        flags: Flags of v2, such as `NO_REPLY`.
    """

    command: int
    payload: bytes = b""
    direction: Direction = Direction.REQUEST
    version: FrameVersion = FrameVersion.V1
    flags: int = 0

    def encode(self) -> bytes:
        """Return the bytes of the frame.

        Raises:
            InvalidArgumentError: The command, the flags or the payload do not fit the encoding.
        """
        self._check()
        if self.version is FrameVersion.V2:
            body = self._v2_body()
            return f"$X{self.direction}".encode("ascii") + body + bytes([crc8(body)])
        if self.version is FrameVersion.V2_OVER_V1:
            body = self._v2_body()
            return self._encode_v1(V2_OVER_V1_COMMAND, body + bytes([crc8(body)]))
        return self._encode_v1(self.command, self.payload)

    def _encode_v1(self, command: int, payload: bytes) -> bytes:
        size = len(payload)
        if size < JUMBO_SIZE and self.version is not FrameVersion.JUMBO:
            body = bytes([size, command]) + payload
        else:
            body = bytes([JUMBO_SIZE, command]) + size.to_bytes(2, "little") + payload
        return f"$M{self.direction}".encode("ascii") + body + bytes([xor8(body)])

    def _v2_body(self) -> bytes:
        size = len(self.payload).to_bytes(2, "little")
        return bytes([self.flags]) + self.command.to_bytes(2, "little") + size + self.payload

    def _check(self) -> None:
        is_v2 = self.version in (FrameVersion.V2, FrameVersion.V2_OVER_V1)
        highest = 0xFFFF if is_v2 else MAX_V1_COMMAND
        if not 0 <= self.command <= highest:
            raise InvalidArgumentError(f"MSP command must be 0 to {highest}, got {self.command}")
        if len(self.payload) > MAX_PAYLOAD:
            raise InvalidArgumentError(
                f"MSP payload must have at most {MAX_PAYLOAD} bytes, got {len(self.payload)}"
            )
        if not 0 <= self.flags <= (0xFF if is_v2 else 0):
            raise InvalidArgumentError(f"flags must be 0 to 255, and 0 without v2, got {self.flags}")


def xor8(data: bytes | bytearray) -> int:
    """Return the checksum of v1: the exclusive or of all bytes."""
    return reduce(xor, data, 0)


def crc8(data: bytes | bytearray) -> int:
    """Return the checksum of v2, CRC-8/DVB-S2: polynomial 0xD5, from 0, not reflected."""
    crc = 0
    for byte in data:
        crc = _CRC_TABLE[crc ^ byte]
    return crc


def _crc_of_byte(crc: int) -> int:
    for _ in range(8):
        crc = (crc << 1) ^ (_POLYNOMIAL if crc & 0x80 else 0)
    return crc & 0xFF


_CRC_TABLE: Final = bytes(_crc_of_byte(byte) for byte in range(256))
