"""The 251 bytes of FILE_TRANSFER_PROTOCOL (guide: file transfer protocol).

    0 sequence (2) · 2 session · 3 opcode · 4 size · 5 req_opcode · 6 burst_complete · 7 padding
    8 offset (4) · 12 data (up to 239)

A reply carries the sequence number of its request plus one, ACK or NAK as opcode, and the request's opcode
in `req_opcode`. A NAK's first byte of data is the error, for FAILERRNO the second is the server's errno. The
checksum of a file is CRC-32 with a register that starts at 0 and is not inverted at the end: not zlib's.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from struct import Struct
from typing import TYPE_CHECKING
from zlib import crc32 as inverted_crc32

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from typing import Self

    from mavstack.dialects import Message

Opcode = common.MavFtpOpcode
FtpError = common.MavFtpErr

MAX_DATA = 239
SEQUENCES = 1 << 16
ALL_ONES = 0xFFFFFFFF

_HEADER = Struct("<HBBBBBxI")
_ERROR_TEXTS = (
    "no reason given",
    "failed",
    "failed on the server's file system",
    "wrong payload size",
    "no such session",
    "all sessions are in use",
    "past the end of the file",
    "unknown operation",
    "already exists",
    "write-protected",
    "not found",
)


@dataclass(frozen=True, slots=True)
class FtpPayload:
    """A request or reply; `size` is the size of the data, or in a read request the number of bytes wanted."""

    sequence: int
    opcode: int
    session: int = 0
    size: int = 0
    req_opcode: int = 0
    burst_complete: bool = False
    offset: int = 0
    data: bytes = b""

    @classmethod
    def request(
        cls, opcode: int, data: bytes = b"", *, session: int = 0, size: int | None = None, offset: int = 0
    ) -> Self:
        """Return a request without a sequence number; `size` None is the size of the data."""
        if len(data) > MAX_DATA:
            raise InvalidArgumentError(f"a payload holds at most {MAX_DATA} bytes, got {len(data)}")
        if not 0 <= offset <= ALL_ONES:
            raise InvalidArgumentError(f"offset must fit into 32 bits, got {offset}")
        return cls(0, int(opcode), session, len(data) if size is None else size, offset=offset, data=data)

    @classmethod
    def read(cls, message: Message) -> Self | None:
        """Decode the payload of a message; None if it is not a FILE_TRANSFER_PROTOCOL."""
        if not isinstance(message, common.FileTransferProtocol):
            return None
        raw = message.payload
        sequence, session, opcode, size, req_opcode, complete, offset = _HEADER.unpack_from(raw)
        data = raw[_HEADER.size : _HEADER.size + size]
        return cls(sequence, opcode, session, size, req_opcode, bool(complete), offset, data)

    def numbered(self, sequence: int) -> Self:
        """Return a copy with a sequence number."""
        return replace(self, sequence=sequence % SEQUENCES)

    def to_bytes(self) -> bytes:
        """Encode the payload, without padding at the end."""
        header = _HEADER.pack(
            self.sequence,
            self.session,
            self.opcode,
            self.size,
            self.req_opcode,
            self.burst_complete,
            self.offset,
        )
        return header + self.data

    def to_message(self, target_system: int, target_component: int) -> common.FileTransferProtocol:
        """Return the message that carries the payload."""
        return common.FileTransferProtocol(
            target_system=target_system, target_component=target_component, payload=self.to_bytes()
        )

    @property
    def error(self) -> int | None:
        """The MAV_FTP_ERR of a NAK; None otherwise."""
        if self.opcode != Opcode.NAK:
            return None
        return self.data[0] if self.data else int(FtpError.FAIL)

    @property
    def errno(self) -> int | None:
        """The server's errno, if a NAK has one."""
        return self.data[1] if self.error == FtpError.FAILERRNO and len(self.data) > 1 else None

    def answers(self, request: Self) -> bool:
        """Return whether this is the reply to a request."""
        return (
            self.opcode in (Opcode.ACK, Opcode.NAK)
            and self.req_opcode == request.opcode
            and self.sequence == (request.sequence + 1) % SEQUENCES
        )


def file_crc32(data: bytes, crc: int = 0) -> int:
    """Return the checksum of a file, or of its next piece if `crc` is that of the data before."""
    return inverted_crc32(data, crc ^ ALL_ONES) ^ ALL_ONES


def error_text(code: int, errno: int | None = None) -> str:
    """Return an error in words."""
    text = _ERROR_TEXTS[code] if code < len(_ERROR_TEXTS) else f"error {code}"
    return text if errno is None else f"{text} (errno {errno})"


def path_bytes(path: str, max_length: int = MAX_DATA) -> bytes:
    """Encode a path; raises InvalidArgumentError if it cannot be sent."""
    data = path.encode("utf-8", "surrogateescape")
    if not data or len(data) > max_length or b"\0" in data:
        raise InvalidArgumentError(f"a path must have 1 to {max_length} bytes without NUL, got {path[:60]!r}")
    return data
