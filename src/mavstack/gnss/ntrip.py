"""The client of NTRIP 1 and 2, sans-IO: requests, answers, source tables.

The request is one of version 2 (HTTP/1.1), which casters of version 1 answer as well: with `ICY 200 OK` and
the bare stream, or with `SOURCETABLE 200 OK` if they do not know the mountpoint. Version 2 answers as HTTP,
often in chunks. `version=1` in the URL asks as version 1 does, for casters that refuse the header.

    ntrip://USER:PASSWORD@HOST:PORT/MOUNTPOINT[?version=1&gga=10]
    ntrips://…                                  over TLS

Sources: RTCM 10410.1 (NTRIP 2.0); BKG, NTRIP documentation 1.0.
"""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass, field
from typing import Final
from urllib.parse import parse_qsl, quote, unquote, urlsplit

from mavstack.errors import LinkError, LinkURLError

DEFAULT_PORTS: Final = {"ntrip": 2101, "ntrips": 443}
#: Seconds between two GGA sentences, for casters that compute a virtual station.
DEFAULT_GGA_INTERVAL: Final = 10.0
_MIN_GGA_INTERVAL: Final = 1.0
_MAX_HEADER: Final = 16_384
_MAX_TABLE: Final = 4_000_000
_USER_AGENT: Final = "NTRIP Mavstack/1.0"
_END_OF_TABLE: Final = b"ENDSOURCETABLE"
_MAX_CHUNK_LINE: Final = 64
_EMPTY_LINE: Final = b"\r\n"
#: Status codes after which a retry is useless.
_PERMANENT: Final = frozenset({400, 401, 403, 404, 407})


@dataclass(frozen=True, slots=True)
class NtripURL:
    """The parts of the URL of a caster.

    Attributes:
        host: The host.
        port: The TCP port.
        mountpoint: The mountpoint; empty asks for the source table.
        user: The name of the user; empty without authentication.
        password: The password.
        tls: True for a connection over TLS.
        version: The version of the request, 1 or 2.
        gga_interval: Seconds between two GGA sentences; 0 sends none.
    """

    host: str
    port: int
    mountpoint: str = ""
    user: str = ""
    password: str = field(default="", repr=False)
    tls: bool = False
    version: int = 2
    gga_interval: float = DEFAULT_GGA_INTERVAL

    @classmethod
    def parse(cls, url: str) -> NtripURL:
        """Parse a URL.

        Raises:
            LinkURLError: The URL is malformed.
        """
        try:
            parts = urlsplit(url)
            port = parts.port
        except ValueError as error:
            raise LinkURLError(f"the URL of the caster is malformed: {error}") from None
        if parts.scheme not in DEFAULT_PORTS or not parts.hostname:
            raise LinkURLError("the URL of a caster is ntrip://USER:PASSWORD@HOST:PORT/MOUNTPOINT")
        options = dict(parse_qsl(parts.query, keep_blank_values=True))
        if unknown := sorted(options.keys() - {"version", "gga"}):
            raise LinkURLError(f"unknown option {unknown[0]!r} of an NTRIP URL; there are version and gga")
        return cls(
            parts.hostname,
            port or DEFAULT_PORTS[parts.scheme],
            unquote(parts.path.removeprefix("/")),
            unquote(parts.username or ""),
            unquote(parts.password or ""),
            parts.scheme == "ntrips",
            _version(options.get("version", "2")),
            _interval(options.get("gga")),
        )

    def __str__(self) -> str:
        """Return the URL without user and password."""
        scheme = "ntrips" if self.tls else "ntrip"
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{scheme}://{host}:{self.port}/{quote(self.mountpoint)}"


def _version(text: str) -> int:
    if text not in ("1", "2"):
        raise LinkURLError(f"version of an NTRIP URL must be 1 or 2, got {text!r}")
    return int(text)


def _interval(text: str | None) -> float:
    try:
        seconds = DEFAULT_GGA_INTERVAL if text is None else float(text)
    except ValueError:
        seconds = -1.0
    if seconds != 0 and not _MIN_GGA_INTERVAL <= seconds < 3600:
        raise LinkURLError(f"gga of an NTRIP URL must be 0, or from 1 to 3600 seconds, got {text!r}")
    return seconds


@dataclass(frozen=True, slots=True)
class SourceTableEntry:
    """A stream of a caster (a line STR of its source table).

    Attributes:
        mountpoint: The mountpoint.
        place: The place of the station.
        format: The format, such as "RTCM 3.2".
        details: The messages and their intervals in seconds.
        systems: The satellite systems.
        latitude: Degrees; None if not given.
        longitude: Degrees; None if not given.
        needs_gga: True if the caster needs the position of the receiver.
    """

    mountpoint: str
    place: str
    format: str
    details: str
    systems: str
    latitude: float | None
    longitude: float | None
    needs_gga: bool

    @classmethod
    def parse(cls, line: str) -> SourceTableEntry | None:
        """Parse a line of a source table; None for other lines than STR."""
        words = line.strip().split(";")
        if words[0] != "STR" or len(words) < 5:
            return None
        words += [""] * (12 - len(words))
        return cls(
            words[1], words[2], words[3], words[4], words[6], _number(words[9]), _number(words[10]),
            words[11].strip() == "1",
        )  # fmt: skip


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


class CasterError(LinkError):
    """A caster refused the request; a repetition may help unless `permanent`."""

    def __init__(self, text: str, *, permanent: bool) -> None:
        self.permanent = permanent
        super().__init__(text)


class NtripClient:
    """One request to a caster: the bytes to send, and the corrections or the source table in its answer.

    Args:
        url: The parts of the URL.
    """

    def __init__(self, url: NtripURL) -> None:
        self._url = url
        self._buffer = bytearray()
        self._body: _PlainBody | _IcyBody | _ChunkedBody | None = None
        self._is_table = False
        self._table = bytearray()
        #: True once the caster accepted the request; False before.
        self.is_streaming = False
        #: The streams of the caster once the source table is complete; None before, or if a stream was
        #: requested.
        self.source_table: list[SourceTableEntry] | None = None

    def request(self, gga: bytes = b"") -> bytes:
        """Return the request, with the first GGA sentence of the receiver if there is one."""
        url = self._url
        path = "/" + quote(url.mountpoint)
        host = f"[{url.host}]" if ":" in url.host else url.host
        lines = [f"GET {path} HTTP/1.{int(url.version == 2)}"]
        if url.version == 2:
            lines += [f"Host: {host}:{url.port}", "Ntrip-Version: Ntrip/2.0"]
        lines += [f"User-Agent: {_USER_AGENT}"]
        if url.user:
            token = b64encode(f"{url.user}:{url.password}".encode()).decode()
            lines += [f"Authorization: Basic {token}"]
        if url.version == 2 and gga:
            lines += [f"Ntrip-GGA: {gga.decode('ascii').strip()}"]
        lines += ["Connection: close"] if url.version == 2 else []
        return ("\r\n".join(lines) + "\r\n\r\n").encode()

    def feed(self, data: bytes) -> bytes:
        """Process bytes of the caster, and return the corrections in them.

        Raises:
            CasterError: The caster refused the request, or its answer is not one of NTRIP.
        """
        if self._body is None:
            self._buffer += data
            data = self._read_head()
        if self._body is None or not data:
            return b""
        content = self._body.feed(data)
        if not self._is_table:
            return content
        self._read_table(content)
        return b""

    def end(self) -> None:
        """Handle that the caster closed the connection; a source table without its last line is complete."""
        if self._is_table and self.source_table is None:
            self._finish_table()

    def _read_head(self) -> bytes:
        """Read the head of the answer if it is complete; return the bytes behind it."""
        line, separator, _ = bytes(self._buffer).partition(b"\r\n")
        if not separator:
            if len(self._buffer) > _MAX_HEADER:
                raise self._failed("the answer is not one of NTRIP", permanent=True)
            return b""
        status = line.decode("latin-1").strip()
        if status.startswith("ICY 200"):
            return self._begin(len(line) + 2, _IcyBody())
        head, separator, _ = bytes(self._buffer).partition(b"\r\n\r\n")
        if not separator and not status.startswith("SOURCETABLE"):
            if len(self._buffer) > _MAX_HEADER:
                raise self._failed("the answer is not one of NTRIP", permanent=True)
            if not status.startswith("HTTP/"):
                self._check_status(status)
            return b""
        return self._begin_http(status, head if separator else line, 4 if separator else 2)

    def _begin_http(self, status: str, head: bytes, gap: int) -> bytes:
        fields = {
            name.strip().lower(): value.strip().lower()
            for name, _, value in (row.partition(":") for row in head.decode("latin-1").split("\r\n")[1:])
        }
        self._is_table = status.startswith("SOURCETABLE 200") or fields.get("content-type", "").startswith(
            "gnss/sourcetable"
        )
        if not self._is_table or status.startswith("HTTP/"):
            self._check_status(status)
        if self._is_table and self._url.mountpoint:
            raise self._failed(f"it has no mountpoint {self._url.mountpoint}", permanent=True)
        chunked = "chunked" in fields.get("transfer-encoding", "")
        return self._begin(len(head) + gap, _ChunkedBody(self._url) if chunked else _PlainBody())

    def _check_status(self, status: str) -> None:
        words = status.split()
        code = int(words[1]) if len(words) > 1 and words[1].isdecimal() else 0
        if "401" in words or "Bad Password" in status:
            raise self._failed("it refused user and password", permanent=True)
        if code != 200 or not status.startswith("HTTP/"):
            raise self._failed(f"it answered {status[:80]!r}", permanent=code in _PERMANENT)

    def _begin(self, start: int, body: _PlainBody | _IcyBody | _ChunkedBody) -> bytes:
        self._body, self.is_streaming = body, not self._is_table
        rest = bytes(self._buffer[start:])
        self._buffer.clear()
        return rest

    def _read_table(self, content: bytes) -> None:
        self._table += content
        if _END_OF_TABLE in self._table or len(self._table) > _MAX_TABLE:
            self._finish_table()

    def _finish_table(self) -> None:
        lines = self._table.decode("utf-8", "replace").splitlines()
        entries = (SourceTableEntry.parse(line) for line in lines)
        self.source_table = [entry for entry in entries if entry is not None]

    def _failed(self, reason: str, *, permanent: bool) -> CasterError:
        return CasterError(f"opening {self._url} failed: {reason}", permanent=permanent)


class _PlainBody:
    """A body that ends with the connection."""

    def feed(self, data: bytes) -> bytes:
        return data


class _IcyBody:
    """The body of a caster of version 1, which sends an empty line behind ICY 200 OK, or none."""

    def __init__(self) -> None:
        self._line: bytes | None = b""

    def feed(self, data: bytes) -> bytes:
        if self._line is None:
            return data
        start = self._line + data
        if len(start) < len(_EMPTY_LINE) and _EMPTY_LINE.startswith(start):
            self._line = start
            return b""
        self._line = None
        return start.removeprefix(_EMPTY_LINE)


class _ChunkedBody:
    """A body in chunks, each behind its size in hexadecimal digits."""

    def __init__(self, url: NtripURL) -> None:
        self._url = url
        self._buffer = bytearray()
        self._left = 0

    def feed(self, data: bytes) -> bytes:
        self._buffer += data
        content = bytearray()
        while self._buffer:
            if self._left > 2:
                part = self._buffer[: self._left - 2]
                content += part
                self._take(len(part))
            elif self._left:
                self._take(min(self._left, len(self._buffer)))
            elif not self._read_size():
                break
        return bytes(content)

    def _take(self, count: int) -> None:
        del self._buffer[:count]
        self._left -= count

    def _read_size(self) -> bool:
        line, separator, _ = bytes(self._buffer[:_MAX_HEADER]).partition(b"\r\n")
        if len(line) > _MAX_CHUNK_LINE + (not separator):
            raise self._malformed()
        if not separator:
            return False
        try:
            size = int(line.split(b";")[0], 16)
        except ValueError:
            raise self._malformed() from None
        del self._buffer[: len(line) + 2]
        self._left = size + 2
        return True

    def _malformed(self) -> CasterError:
        return CasterError(f"reading {self._url} failed: its chunks are malformed", permanent=False)
