"""The replies of an FTP server: acknowledgements, and refusals with their error."""

from __future__ import annotations

from errno import EEXIST, ENOENT, ENOTDIR

from mavstack.services.ftp.payload import SEQUENCES, FtpError, FtpPayload, Opcode


class RefusedError(Exception):
    """The request is answered by a NAK."""

    def __init__(self, code: int) -> None:
        super().__init__(code)
        self.code = code


def ack(request: FtpPayload, data: bytes = b"") -> FtpPayload:
    """Return the acknowledgement of a request."""
    return FtpPayload(
        (request.sequence + 1) % SEQUENCES,
        Opcode.ACK,
        request.session,
        len(data),
        request.opcode,
        offset=request.offset,
        data=data,
    )


def nak(request: FtpPayload, code: int, errno: int | None = None, *, of_burst: bool = False) -> FtpPayload:
    """Return the refusal of a request, or the end of a burst whose reply was to be `request`."""
    data = bytes([code]) if errno is None else bytes([code, errno & 0xFF])
    return FtpPayload(
        request.sequence if of_burst else (request.sequence + 1) % SEQUENCES,
        Opcode.NAK,
        request.session,
        len(data),
        request.req_opcode if of_burst else request.opcode,
        of_burst,
        request.offset,
        data,
    )


def error_code(error: OSError) -> tuple[int, int | None]:
    """Return the MAV_FTP_ERR of an error of the store, and its errno if that is sent too."""
    if isinstance(error, FileNotFoundError) or error.errno in (ENOENT, ENOTDIR):
        return FtpError.FILENOTFOUND, None
    if isinstance(error, FileExistsError) or error.errno == EEXIST:
        return FtpError.FILEEXISTS, None
    if isinstance(error, PermissionError):
        return FtpError.FILEPROTECTED, None
    return FtpError.FAILERRNO, error.errno or 0


def read_path(data: bytes) -> str:
    """Decode a path; some clients include its NUL."""
    path = data.removesuffix(b"\0")
    if not path or b"\0" in path:
        raise RefusedError(FtpError.INVALIDDATASIZE)
    return path.decode("utf-8", "surrogateescape")
