"""Parsing of link URLs.

The canonical form is `scheme://address?option=value&…`. The forms of other programs are accepted with their
meaning: `udp:host:port` listens and `tcp:host:port` connects (pymavlink, MAVProxy), `/dev/ttyACM0,57600` and
`serial:///dev/ttyACM0:57600` have the baud rate after the device, `COM3` is a serial port, and a path or a
`*.tlog` name is a file to replay. A bare `host:port` is refused, because some programs listen on it and
others send to it. Parsing does no input or output; `str()` of a parsed URL is its canonical form, which
parses to an equal URL.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NoReturn
from urllib.parse import parse_qsl, quote, unquote, urlencode

from mavstack.errors import LinkURLError

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

EXAMPLES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "udpin": "udpin://0.0.0.0:14550",
        "udpout": "udpout://192.168.1.10:14550",
        "tcpin": "tcpin://0.0.0.0:5760",
        "tcpout": "tcpout://127.0.0.1:5760",
        "tls": "tls://ground.example:5761?ca=ca.pem",
        "tlsin": "tlsin://0.0.0.0:5761?cert=cert.pem&key=key.pem",
        "serial": "serial:///dev/ttyACM0?baud=57600",
        "pty": "pty:///tmp/ttyDrone",
        "unix": "unix:///run/mavlink.sock",
        "unixin": "unixin:///run/mavlink.sock",
        "ws": "ws://127.0.0.1:5770/mavlink",
        "wss": "wss://ground.example/mavlink",
        "wsin": "wsin://0.0.0.0:5770",
        "wssin": "wssin://0.0.0.0:5770?cert=cert.pem&key=key.pem",
        "sealed+udpin": "sealed+udpin://0.0.0.0:14560?shared_key=fleet",
        "sealed+udpout": "sealed+udpout://ground.example:14560?shared_key=fleet",
        "sealed+tcpin": "sealed+tcpin://0.0.0.0:5762?private_key=ground&peer=peers.txt",
        "sealed+tcpout": "sealed+tcpout://ground.example:5762?private_key=boat&peer=ground.pub",
        "sealed+serial": "sealed+serial:///dev/ttyUSB0?baud=57600&shared_key=fleet",
        "file": "file://flight.tlog?speed=2",
        "memory": "memory://fleet",
    }
)

_ALIASES: Final[Mapping[str, tuple[str, Mapping[str, str]]]] = MappingProxyType(
    {
        "udp": ("udpin", {}),
        "udpbcast": ("udpout", {}),
        "tcp": ("tcpout", {}),
        "tlsout": ("tls", {}),
        "sealed+udp": ("sealed+udpin", {}),
        "sealed+tcp": ("sealed+tcpout", {}),
        "serial_flowcontrol": ("serial", {"flow": "rtscts"}),
        "wsserver": ("wsin", {}),
    }
)

#: The prefix of the schemes of sealed links, in front of the scheme of the link that they use.
SEALED: Final = "sealed+"
_LISTENERS = frozenset({"udpin", "tcpin", "tlsin", "wsin", "wssin", "sealed+udpin", "sealed+tcpin"})
_PATHS = frozenset({"serial", "pty", "unix", "unixin", "file", "memory", "sealed+serial"})
_WEB_PORTS: Final[Mapping[str, int]] = MappingProxyType({"ws": 80, "wss": 443})
_RECORDINGS = (".tlog", ".rlog", ".raw")

_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9_+.-]+):(//)?(.*)", re.DOTALL)
_HOST_PORT = re.compile(r"(?:\[([^\[\]]*)\]|([^:/\[\]\s]*))(?::([^:/]*))?")
_DEVICE_BAUD = re.compile(r"(.*?)(?:,(\d+)|:(\d{4,}))", re.DOTALL)
_DRIVE = re.compile(r"/[A-Za-z]:[/\\]")  # file:///C:/logs/flight.tlog
_BARE_SERIAL = re.compile(r"/dev/.+|COM\d+([:,]\d+)?|\\\\\.\\COM\d+([:,]\d+)?", re.IGNORECASE | re.DOTALL)


@dataclass(frozen=True, slots=True)
class LinkURL:
    """A parsed link URL.

    Attributes:
        scheme: The canonical scheme, such as `udpin`.
        host: The host name or address, or an empty string.
        port: The port, or 0.
        path: The path, device or file, or an empty string.
        options: The options as text.
    """

    scheme: str
    host: str = ""
    port: int = 0
    path: str = ""
    options: Mapping[str, str] = field(default_factory=dict, hash=False)

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        address = f"{host}:{self.port}" if self.host else ""
        query = "?" + urlencode(self.options, safe="/:.") if self.options else ""
        return f"{self.scheme}://{address}{quote(self.path, safe=_PATH_SAFE)}{query}"

    @property
    def redacted(self) -> str:
        """The canonical form with `***` in place of keys, passwords and tokens, for errors and logs."""
        return redact_options(str(self))

    def with_options(self, **options: object) -> LinkURL:
        """Return the URL with options added or replaced.

        Args:
            options: The options by name; True and False become yes and no.

        Returns:
            A new URL.
        """
        texts = {name: _option_text(value) for name, value in options.items()}
        return replace(self, options={**self.options, **texts})


_PATH_SAFE = "/:\\,.~@+=&[]"  # brackets: other schemes may carry the address of a host
_SECRET_OPTION = re.compile(r"([?&][^=&]*(?:pass|secret|token|key|header\.)[^=&]*=)[^&]+", re.IGNORECASE)


def redact_options(text: str) -> str:
    """Replace the values of the secret options in the text of a URL by `***`."""
    return _SECRET_OPTION.sub(r"\1***", text)


def parse_url(text: str, plugins: Collection[str] = ()) -> LinkURL:
    """Parse a link URL.

    Args:
        text: The URL, or a form of another program.
        plugins: Schemes beyond the built-in ones.

    Returns:
        The parsed URL.

    Raises:
        LinkURLError: The URL is malformed; the text contains a valid example.
    """
    text = text.strip()
    if not text:
        _refuse(text, "it is empty")
    match = _SCHEME.fullmatch(text)
    if match is None or _BARE_SERIAL.fullmatch(text.partition("?")[0]):
        return _parse_bare(text)
    scheme, slashes, rest = match[1].lower(), match[2], match[3]
    if scheme not in EXAMPLES and scheme not in _ALIASES and scheme not in plugins:
        return _unknown_scheme(text, scheme) if slashes else _parse_bare(text)
    scheme, implied = _ALIASES.get(scheme, (scheme, {}))
    body, options = _split_query(text, rest, scheme)
    options = {**implied, **options}
    if scheme in _PATHS:
        return _parse_path(text, scheme, unquote(body) if slashes else body, options)
    if scheme in EXAMPLES:
        return _parse_network(text, scheme, body, options)
    return LinkURL(scheme, path=unquote(body), options=options)


def _parse_bare(text: str) -> LinkURL:
    """Parse a text without a scheme: a device or a file."""
    body, _, _ = text.partition("?")
    if _BARE_SERIAL.fullmatch(body):
        return _parse_path(text, "serial", *_split_query(text, text, "serial"))
    if "/" in body or "\\" in body or body.lower().endswith(_RECORDINGS):
        return _parse_path(text, "file", *_split_query(text, text, "file"))
    if re.fullmatch(r"\S+:\d+", text):
        problem = f"it has no scheme: udpin://{text} listens, udpout://{text} sends, tcpout://{text} connects"
        raise LinkURLError(f"invalid link URL {redact_options(text)!r}: {problem}")
    return _refuse(text, "it has no scheme, and is not a device or file")


def _parse_path(text: str, scheme: str, body: str, options: dict[str, str]) -> LinkURL:
    if scheme == "file" and _DRIVE.match(body):
        body = body[1:]
    if scheme.removeprefix(SEALED) == "serial" and (match := _DEVICE_BAUD.fullmatch(body)):
        body = match[1]
        options = {"baud": match[2] or match[3], **options}
    if not body.strip("/"):
        _refuse(
            text,
            {"serial": "it has no device", "memory": "it has no name"}.get(
                scheme.removeprefix(SEALED), "it has no path"
            ),
            scheme,
        )
    return LinkURL(scheme, path=body, options=options)


def _parse_network(text: str, scheme: str, body: str, options: dict[str, str]) -> LinkURL:
    authority, slash, path = body.partition("/")
    web = scheme.startswith("ws")
    if path and not web:
        _refuse(text, f"{scheme} takes no path ({slash + path})", scheme)
    match = _HOST_PORT.fullmatch(authority)
    if match is None:
        problem = (
            "an IPv6 address needs brackets, as in [::1]"
            if authority.count(":") > 1
            else "the host is not valid"
        )
        _refuse(text, problem, scheme)
    host = match[1] if match[1] is not None else match[2]
    port = _port(text, scheme, match[3])
    if not host and scheme not in _LISTENERS:
        _refuse(text, "it has no host", scheme)
    return LinkURL(scheme, host or "0.0.0.0", port, "/" + unquote(path) if web else "", options)  # noqa: S104


def _port(text: str, scheme: str, digits: str | None) -> int:
    if not digits:
        if scheme not in _WEB_PORTS:
            _refuse(text, "it has no port", scheme)
        return _WEB_PORTS[scheme]
    if not (digits.isascii() and digits.isdigit()):
        _refuse(text, f"the port {digits!r} is not a number", scheme)
    port = int(digits)
    minimum = 0 if scheme in _LISTENERS else 1
    if not minimum <= port <= 65535:
        _refuse(text, f"the port {port} is not between {minimum} and 65535", scheme)
    return port


def _split_query(text: str, rest: str, scheme: str) -> tuple[str, dict[str, str]]:
    body, _, query = rest.partition("?")
    query = query.strip("&")
    try:
        pairs = parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query))
    except ValueError:
        _refuse(text, "its options do not have the form name=value&name=value", scheme)
    options = dict(pairs)
    if len(options) < len(pairs):
        _refuse(text, "an option is given twice", scheme)
    return body, options


def _option_text(value: object) -> str:
    return ("yes" if value else "no") if isinstance(value, bool) else str(value)


def _unknown_scheme(text: str, scheme: str) -> NoReturn:
    near = get_close_matches(scheme, [*EXAMPLES, *_ALIASES], n=1)
    hint = f"did you mean {near[0]}?" if near else "known schemes: " + ", ".join(EXAMPLES)
    _refuse(text, f"unknown scheme {scheme!r}; {hint}", near[0] if near else "udpin")


def _refuse(text: str, problem: str, scheme: str = "udpin") -> NoReturn:
    scheme = _ALIASES[scheme][0] if scheme in _ALIASES else scheme
    example = EXAMPLES.get(scheme, EXAMPLES["udpin"])
    raise LinkURLError(f"invalid link URL {redact_options(text)!r}: {problem}; for example: {example}")
