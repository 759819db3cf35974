"""Configuration files of mavlink-router, read as they are.

    converted = read_mavlink_router_config("/etc/mavlink-router/main.conf")
    converted.config, converted.notes

The meaning is kept, defaults included: a TCP server on port 5760 runs unless it is turned off, and TCP
clients wait for their server. Each setting that has no equal here is a note with its line; settings that
mavlink-router itself would not understand are errors.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NoReturn
from urllib.parse import quote, urlencode

from mavstack.bounded_file import read_file_bounded
from mavstack.errors import RouterConfigError
from mavstack.router.config import EndpointConfig, PacketFilter, Recording, RouterConfig
from mavstack.router.config.tables import MAX_FILE_SIZE

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator

DEFAULT_TCP_PORT: Final = 5760
DEFAULT_BAUD: Final = 115_200
DEFAULT_RETRY: Final = 5
FIRST_UDP_PORT: Final = 14_550
#: Maximum size of a file of a telemetry log in bytes; then the next file begins.
LOG_FILE_SIZE: Final = 1_000_000_000

_FILTERS: Final = {
    f"{verb}{kind}{direction}".lower(): (direction, f"{ours}_{plural}")
    for verb, ours in (("Allow", "allow"), ("Block", "deny"))
    for kind, plural in (("MsgId", "messages"), ("SrcComp", "components"), ("SrcSys", "systems"))
    for direction in ("In", "Out")
}
_COMMON: Final = frozenset({*_FILTERS, "group"})
_KEYS: Final = {
    "general": frozenset(
        {
            "tcpserverport", "reportstats", "debugloglevel", "deduplicationperiod", "sniffersysid", "log",
            "logmode", "mavlinkdialect", "minfreespace", "maxlogfiles", "logsystemid", "logtelemetry",
        }
    ),
    "uartendpoint": _COMMON | {"device", "baud", "flowcontrol"},
    "udpendpoint": _COMMON | {"address", "mode", "port", "filter"},
    "tcpendpoint": _COMMON | {"address", "port", "retrytimeout"},
}  # fmt: skip
_ADDRESS: Final = re.compile(r"\d{1,3}(\.\d{1,3}){3}|\[[0-9a-fA-F:.]+(%\w+)?\]")
#: The remedy for each setting without an equivalent.
_ELSEWHERE: Final = {
    "reportstats": "statistics are shown by the live picture and by `mav route ctl stats`",
    "debugloglevel": "use -v or -vv",
    "sniffersysid": "no endpoint gets packets for other systems; record them instead (`record = …`)",
    "logsystemid": "download logs by `mav log get`",
    "mavlinkdialect": "all dialects are known",
    "minfreespace": "limit the files by max_size and keep",
}


@dataclass(frozen=True, slots=True)
class ConvertedConfig:
    """A configuration, and what it does not express.

    Attributes:
        config: The configuration.
        notes: Settings without an equal, each with file and line and what to do instead.
    """

    config: RouterConfig
    notes: tuple[str, ...]


@dataclass(slots=True)
class _Section:
    """One section: its values and their lines, by keys in lower case."""

    kind: str
    name: str
    line: int
    values: dict[str, str] = field(default_factory=dict)
    lines: dict[str, int] = field(default_factory=dict)


def read_mavlink_router_config(path: str | os.PathLike[str]) -> ConvertedConfig:
    """Read a configuration file of mavlink-router.

    Args:
        path: Path of the file.

    Returns:
        The configuration, and notes about what it does not express.

    Raises:
        RouterConfigError: The file cannot be read, or is not valid; the text has the line.
    """
    try:
        data = read_file_bounded(path, MAX_FILE_SIZE)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise RouterConfigError(f"cannot open {path}: {reason}") from None
    return parse_mavlink_router_config(data.decode("utf-8", "replace"), str(path))


def parse_mavlink_router_config(text: str, path: str = "<text>") -> ConvertedConfig:
    """Read a configuration of mavlink-router from text.

    Args:
        text: The text.
        path: Name of the file in error texts.

    Returns:
        The configuration, and notes about what it does not express.

    Raises:
        RouterConfigError: The text is not valid.
    """
    converter = _Converter(path)
    sections = list(_sections(text, path))
    for section in sections:
        converter.add(section)
    if not any(section.kind == "general" for section in sections):
        converter.add(_Section("general", "", 1))
    window = converter.window
    return ConvertedConfig(RouterConfig(tuple(converter.endpoints), window), tuple(converter.notes))


def _sections(text: str, path: str) -> Iterator[_Section]:
    """Yield the sections; a section that occurs again continues the first one of its name."""
    found: dict[tuple[str, str], _Section] = {}
    section: _Section | None = None
    for number, raw in enumerate(text.split("\n"), 1):
        line = raw.strip()
        if not line or line[0] in "#;":
            continue
        if line.startswith("["):
            section = _header(line, number, path)
            section = found.setdefault((section.kind, section.name.lower()), section)
            continue
        key, equals, value = (part.strip() for part in line.partition("="))
        if section is None:
            raise RouterConfigError("a setting before the first section, such as [General]", path, number)
        if not (key and equals and value):
            raise RouterConfigError(f"{line!r} is not a setting of the form Key = Value", path, number)
        section.values[key.lower()], section.lines[key.lower()] = value, number
    yield from found.values()


def _header(line: str, number: int, path: str) -> _Section:
    if not line.endswith("]"):
        raise RouterConfigError(f"{line!r}: a section ends with ']'", path, number)
    kind, _, name = line[1:-1].partition(" ")
    if " " in name or line[1:-1] != line[1:-1].strip():
        raise RouterConfigError(f"{line!r}: the name of a section has no blanks", path, number)
    return _Section(kind.lower(), name, number)


class _Converter:
    """Collects the endpoints and the notes, section by section."""

    def __init__(self, path: str) -> None:
        self._path = path
        self.endpoints: list[EndpointConfig] = []
        self.notes: list[str] = []
        self.window = 0.0
        self._section = _Section("", "", 1)
        self._udp: set[tuple[str, int]] = set()

    def add(self, section: _Section) -> None:
        """Add one section."""
        self._section = section
        convert: dict[str, Callable[[], None]] = {
            "general": self._add_general,
            "uartendpoint": self._add_uart,
            "udpendpoint": self._add_udp,
            "tcpendpoint": self._add_tcp,
        }
        if section.kind not in convert:
            self._note(section.line, f"the section [{section.kind}] is unknown and has no effect")
            return
        for key in section.values:
            if key not in _KEYS[section.kind]:
                self._note(section.lines[key], f"{key} is unknown and has no effect")
            elif key in _ELSEWHERE:
                self._note(section.lines[key], f"{key} has no equal: {_ELSEWHERE[key]}")
        if section.kind != "general" and not section.name:
            raise RouterConfigError(
                "the section needs a name, such as [UdpEndpoint ground]", self._path, section.line
            )
        convert[section.kind]()

    def _add_general(self) -> None:
        port = self._integer("tcpserverport", DEFAULT_TCP_PORT, 65_535)
        self.window = self._integer("deduplicationperiod", 0, 10_000) / 1000
        if port:
            self.endpoints.append(EndpointConfig("tcp-server", f"tcpin://0.0.0.0:{port}"))
        folder = self._text("log")
        if folder and self._flag("logtelemetry"):
            keep = self._integer("maxlogfiles", 0, 10**9) or None
            file = f"{folder.rstrip('/')}/telemetry.tlog"
            self.endpoints.append(
                EndpointConfig("telemetry-log", record=Recording(file, LOG_FILE_SIZE, keep=keep))
            )
            if self._text("logmode").lower() == "while-armed":
                self._note(
                    self._line("logmode"), "LogMode: telemetry is recorded always, not only while armed"
                )
        elif folder:
            self._note(self._line("log"), "Log: logs of the flight stack are not recorded: use `mav log get`")

    def _add_uart(self) -> None:
        device = self._required("device")
        rates = self._numbers("baud", 10**7) or [DEFAULT_BAUD]
        if len(rates) > 1:
            self._note(self._line("baud"), f"Baud: only the first rate is tried ({rates[0]})")
        options = {"baud": str(rates[0])} | ({"flow": "rtscts"} if self._flag("flowcontrol") else {})
        self._add_endpoint(f"serial://{quote(device)}?{urlencode(options)}")

    def _add_udp(self) -> None:
        mode = self._required("mode").lower()
        if mode not in ("normal", "server", "eavesdropping"):
            self._refuse("mode", "must be Normal or Server")
        host = self._address()
        port = self._integer("port", 0, 65_535)
        if not port and mode == "normal":
            port = next(each for each in range(FIRST_UDP_PORT, 65_536) if (host, each) not in self._udp)
        elif not port:
            self._refuse("port", "is needed in server mode")
        self._udp.add((host, port))
        self._add_endpoint(f"udp{'out' if mode == 'normal' else 'in'}://{host}:{port}")

    def _add_tcp(self) -> None:
        host = self._address()
        self._required("port")
        port = self._integer("port", 0, 65_535)
        retry = self._integer("retrytimeout", DEFAULT_RETRY, 10**6)
        options = (
            {"wait": "yes", "retry": f"{retry}s", "retry_limit": f"{retry}s"}
            if retry
            else {"reconnect": "no"}
        )
        self._add_endpoint(f"tcpout://{host}:{port}?{urlencode(options)}")

    def _add_endpoint(self, url: str) -> None:
        """Add the link of the present section, with its filters."""
        sets: dict[str, dict[str, frozenset[int]]] = {"In": {}, "Out": {}}
        for key, (direction, name) in _FILTERS.items():
            maximum = 0xFFFFFF if name.endswith("messages") else 255
            numbers = self._numbers(key, maximum)
            if not numbers and key == "allowmsgidout":
                numbers = self._numbers("filter", maximum)
            sets[direction][name] = frozenset(numbers)
        self.endpoints.append(
            EndpointConfig(
                name=self._name(),
                url=url,
                group=self._text("group"),
                incoming=PacketFilter(**sets["In"]),
                outgoing=PacketFilter(**sets["Out"]),
            )
        )

    def _name(self) -> str:
        """Return the section's name, without letters that our names cannot have, and unique."""
        name = re.sub(r"[^A-Za-z0-9_.-]", "-", self._section.name).lstrip("_.-")[:48] or "endpoint"
        taken = {each.name for each in self.endpoints} | {"tcp-server", "telemetry-log"}
        kind = self._section.kind.removesuffix("endpoint")
        names = (name, f"{name}-{kind}", *(f"{name}-{number}" for number in range(2, len(taken) + 3)))
        return next(each for each in names if each not in taken)

    def _address(self) -> str:
        address = self._required("address")
        if not _ADDRESS.fullmatch(address):
            self._refuse("address", "must be an IP address; an IPv6 address needs brackets, as in [::1]")
        return address

    def _text(self, key: str) -> str:
        return self._section.values.get(key, "")

    def _line(self, key: str) -> int:
        return self._section.lines.get(key, self._section.line)

    def _required(self, key: str) -> str:
        return self._text(key) or self._refuse(key, "is missing")

    def _flag(self, key: str) -> bool:
        text = self._text(key).lower() or "false"
        if text not in ("true", "false", "0", "1"):
            self._refuse(key, "must be true or false")
        return text in ("true", "1")

    def _integer(self, key: str, default: int, maximum: int) -> int:
        text = self._text(key) or str(default)
        if not re.fullmatch(r"[0-9]{1,12}", text) or int(text) > maximum:
            self._refuse(key, f"must be a number from 0 to {maximum}")
        return int(text)

    def _numbers(self, key: str, maximum: int) -> list[int]:
        found = [part.strip() for part in self._text(key).split(",") if part.strip()]
        if not all(re.fullmatch(r"[0-9]{1,12}", part) and int(part) <= maximum for part in found):
            self._refuse(key, f"must be numbers from 0 to {maximum}, separated by commas")
        return [int(part) for part in found]

    def _note(self, line: int, text: str) -> None:
        self.notes.append(f"{self._path}:{line}: {text}")

    def _refuse(self, key: str, problem: str) -> NoReturn:
        raise RouterConfigError(f"{key} {problem}", self._path, self._line(key))
