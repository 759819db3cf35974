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
from mavstack.errors import FieldRangeError

if TYPE_CHECKING:
    from typing import Self

    from mavstack.dialects import Message

Opcode = common.MavFtpOpcode
FtpError = common.MavFtpErr

MOST_DATA = 239
SEQUENCES = 1 << 16
ALL_ONES = 0xFFFFFFFF

_HEADER = Struct("<HBBBBBxI")
_MEANINGS = (
    "refused without a reason",
    "failed",
    "failed on the server's file system",
    "the payload's size is wrong",
    "the session is not open",
    "all sessions are in use",
    "past the end of the file",
    "the operation is unknown",
    "it exists already",
    "it is write-protected",
    "not found",
)


@dataclass(frozen=True, slots=True)
class FtpPayload:
    """One request or reply; `size` is that of the data, or in a read request what is wanted."""

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
        """A request that has no sequence number yet; `size` is that of the data if not told."""
        if len(data) > MOST_DATA:
            raise FieldRangeError(f"{len(data)} bytes do not fit into one payload, which holds {MOST_DATA}")
        if not 0 <= offset <= ALL_ONES:
            raise FieldRangeError(f"offset {offset} does not fit into 32 bits")
        return cls(0, int(opcode), session, len(data) if size is None else size, offset=offset, data=data)

    @classmethod
    def read(cls, message: Message) -> Self | None:
        """What a message carries; None if it is another message."""
        if not isinstance(message, common.FileTransferProtocol):
            return None
        raw = message.payload
        sequence, session, opcode, size, req_opcode, complete, offset = _HEADER.unpack_from(raw)
        data = raw[_HEADER.size : _HEADER.size + size]
        return cls(sequence, opcode, session, size, req_opcode, bool(complete), offset, data)

    def numbered(self, sequence: int) -> Self:
        """The same with a sequence number."""
        return replace(self, sequence=sequence % SEQUENCES)

    def to_bytes(self) -> bytes:
        """As it lies in the message, without padding at the end."""
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
        """In the message that carries it."""
        return common.FileTransferProtocol(
            target_system=target_system, target_component=target_component, payload=self.to_bytes()
        )

    @property
    def error(self) -> int | None:
        """The error of a NAK; None for anything else."""
        if self.opcode != Opcode.NAK:
            return None
        return self.data[0] if self.data else int(FtpError.FAIL)

    @property
    def errno(self) -> int | None:
        """The server's own error number, if a NAK has one."""
        return self.data[1] if self.error == FtpError.FAILERRNO and len(self.data) > 1 else None

    def answers(self, request: Self) -> bool:
        """Whether this is the reply to that request."""
        return (
            self.opcode in (Opcode.ACK, Opcode.NAK)
            and self.req_opcode == request.opcode
            and self.sequence == (request.sequence + 1) % SEQUENCES
        )


def file_crc32(data: bytes, crc: int = 0) -> int:
    """The checksum of a file, or of its next piece if `crc` is that of what came before."""
    return inverted_crc32(data, crc ^ ALL_ONES) ^ ALL_ONES


def error_text(code: int, errno: int | None = None) -> str:
    """An error in words."""
    meaning = _MEANINGS[code] if code < len(_MEANINGS) else f"error {code}"
    return meaning if errno is None else f"{meaning} (errno {errno})"


def path_bytes(path: str, limit: int = MOST_DATA) -> bytes:
    """A path as it is sent; raises if it cannot be."""
    data = path.encode("utf-8", "surrogateescape")
    if not data or len(data) > limit or b"\0" in data:
        raise FieldRangeError(f"a path has 1 to {limit} bytes without NUL, not {path[:60]!r}")
    return data
