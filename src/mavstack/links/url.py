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
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final, NoReturn
from urllib.parse import parse_qsl, quote, unquote, urlencode

from mavstack.errors import LinkURLError
from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.scheme_table import builtin_schemes, unknown_scheme
from mavstack.links.schemes import file, serial, udp

if TYPE_CHECKING:
    from collections.abc import Collection

(_SERIAL,) = serial.SCHEMES
(_FILE,) = file.SCHEMES
#: The scheme in the example that an error shows for a URL without a scheme.
_USUAL: Final = udp.SCHEMES[0]
_RECORDINGS = (".tlog", ".rlog", ".raw")

_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9_+.-]+):(//)?(.*)", re.DOTALL)
_HOST_PORT = re.compile(r"(?:\[([^\[\]]*)\]|([^:/\[\]\s]*))(?::([^:/]*))?")
_DEVICE_BAUD = re.compile(r"(.*?)(?:,(\d+)|:(\d{4,}))", re.DOTALL)
_DRIVE = re.compile(r"/[A-Za-z]:[/\\]")  # such as in file:///C:/logs/flight.tlog
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


# brackets, since the path of other schemes may contain the IPv6 address of a host
_PATH_SAFE = "/:\\,.~@+=&[]"
_SECRET_OPTION = re.compile(
    r"([?&][^=&]*(?:pass|secret|ticket|token|key|header\.)[^=&]*=)[^&]+", re.IGNORECASE
)


def redact_options(text: str) -> str:
    """Replace the values of the secret options in the text of a URL by `***`."""
    return _SECRET_OPTION.sub(r"\1***", text)


def parse_url(text: str, plugins: Collection[str] = ()) -> LinkURL:
    """Parse a link URL.

    Args:
        text: The URL, or a form of another program.
        plugins: Schemes beyond the built-in ones: a mapping to their records, or names alone, whose address
            may be anything.

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
    name, slashes, rest = match[1].lower(), match[2], match[3]
    scheme, implied = _resolve(name, plugins)
    if scheme is None:
        return _unknown_scheme(text, name) if slashes else _parse_bare(text)
    body, options = _split_query(text, rest, scheme)
    options = {**implied, **options}
    if scheme.is_network:
        return _parse_network(text, scheme, body, options)
    if scheme.address is AddressKind.ANY:
        return LinkURL(scheme.name, path=unquote(body), options=options)
    return _parse_path(text, scheme, unquote(body) if slashes else body, options)


def _resolve(name: str, plugins: Collection[str]) -> tuple[LinkScheme | None, Mapping[str, str]]:
    """Return the record of a scheme or of an alias, and the options that the alias implies."""
    records = {**builtin_schemes(), **_records(plugins)}
    if name in records:
        return records[name], {}
    for each in records.values():
        if name in each.aliases:
            return each, each.aliases[name]
    return None, {}


def _records(plugins: Collection[str]) -> Mapping[str, LinkScheme]:
    if isinstance(plugins, Mapping):
        return plugins
    return {name: unknown_scheme(name) for name in plugins}


def _parse_bare(text: str) -> LinkURL:
    """Parse a text without a scheme: a device or a file."""
    body, _, _ = text.partition("?")
    if _BARE_SERIAL.fullmatch(body):
        return _parse_path(text, _SERIAL, *_split_query(text, text, _SERIAL))
    if "/" in body or "\\" in body or body.lower().endswith(_RECORDINGS):
        return _parse_path(text, _FILE, *_split_query(text, text, _FILE))
    if re.fullmatch(r"\S+:\d+", text):
        problem = f"it has no scheme: udpin://{text} listens, udpout://{text} sends, tcpout://{text} connects"
        raise LinkURLError(f"invalid link URL {redact_options(text)!r}: {problem}")
    return _refuse(text, "it has no scheme, and is not a device or file")


def _parse_path(text: str, scheme: LinkScheme, body: str, options: dict[str, str]) -> LinkURL:
    if scheme is _FILE and _DRIVE.match(body):
        body = body[1:]
    if scheme.is_device and (match := _DEVICE_BAUD.fullmatch(body)):
        body = match[1]
        options = {"baud": match[2] or match[3], **options}
    if not body.strip("/"):
        _refuse(text, f"it has no {scheme.address.value}", scheme)
    return LinkURL(scheme.name, path=body, options=options)


def _parse_network(text: str, scheme: LinkScheme, body: str, options: dict[str, str]) -> LinkURL:
    authority, slash, path = body.partition("/")
    web = scheme.address is AddressKind.WEB
    if path and not web:
        _refuse(text, f"{scheme.name} takes no path ({slash + path})", scheme)
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
    if not host and not scheme.listens:
        _refuse(text, "it has no host", scheme)
    target = "/" + unquote(path) if web else ""
    return LinkURL(scheme.name, host or "0.0.0.0", port, target, options)  # noqa: S104


def _port(text: str, scheme: LinkScheme, digits: str | None) -> int:
    if not digits:
        if not scheme.default_port:
            _refuse(text, "it has no port", scheme)
        return scheme.default_port
    if not (digits.isascii() and digits.isdigit()):
        _refuse(text, f"the port {digits!r} is not a number", scheme)
    port = int(digits)
    minimum = 0 if scheme.listens else 1
    if not minimum <= port <= 65535:
        _refuse(text, f"the port {port} is not between {minimum} and 65535", scheme)
    return port


def _split_query(text: str, rest: str, scheme: LinkScheme) -> tuple[str, dict[str, str]]:
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


def _unknown_scheme(text: str, name: str) -> NoReturn:
    builtin = builtin_schemes()
    aliases = [alias for record in builtin.values() for alias in record.aliases]
    from difflib import get_close_matches

    near = get_close_matches(name, [*builtin, *aliases], n=1)
    hint = f"did you mean {near[0]}?" if near else "known schemes: " + ", ".join(builtin)
    _refuse(text, f"unknown scheme {name!r}; {hint}", _resolve(near[0], ())[0] if near else None)


def _refuse(text: str, problem: str, scheme: LinkScheme | None = None) -> NoReturn:
    example = (scheme or _USUAL).example
    raise LinkURLError(f"invalid link URL {redact_options(text)!r}: {problem}; for example: {example}")
