"""Reading of configurations: TOML to `RouterConfig`.

    config = load_config("router.toml")

Each error names the file and the line and says what is valid. A configuration without errors can still fail
to open: a port may be in use, a device missing.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

from mavstack.bounded_file import read_file_bounded
from mavstack.errors import DialectError, LinkError, MissingExtraError, RouterConfigError
from mavstack.router.config.model import (
    DEFAULT_CONTROL,
    DEFAULT_HIGH_LATENCY_INTERVAL,
    EndpointConfig,
    PacketFilter,
    Recording,
    RouterConfig,
)
from mavstack.router.config.names import Names, system
from mavstack.router.config.quantities import byte_rate, byte_size, duration, hertz
from mavstack.router.config.signing import check_link_settings, read_signing
from mavstack.router.config.tables import MAX_FILE_SIZE, Table

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

MAX_ENDPOINTS: Final = 1000
#: Maximum seconds for which the loop protection keeps packets.
MAX_DUPLICATE_WINDOW: Final = 10.0
_NAME: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}")
_HOST_PORT: Final = re.compile(r"(?:\[[0-9a-fA-F:.]+\]|[A-Za-z0-9_.-]+):(\d{1,5})")
_LOOPBACK: Final = re.compile(r"(127(\.\d{1,3}){3}|localhost|\[::1\]):\d+")


def load_config(path: str | os.PathLike[str]) -> RouterConfig:
    """Read a configuration from a file.

    Args:
        path: Path of the TOML file.

    Returns:
        The configuration.

    Raises:
        RouterConfigError: The file cannot be read, or is not a valid configuration; the text has the line.
    """
    try:
        data = read_file_bounded(path, MAX_FILE_SIZE + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise RouterConfigError(f"cannot open {path}: {reason}") from None
    if len(data) > MAX_FILE_SIZE:
        raise RouterConfigError(f"larger than {MAX_FILE_SIZE >> 20} MiB: not a configuration", str(path))
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise RouterConfigError("not UTF-8 text: save the file as UTF-8", str(path), line) from None
    return parse_config(text, str(path))


def parse_config(text: str, path: str = "<text>") -> RouterConfig:
    """Read a configuration from text.

    Args:
        text: The TOML.
        path: Name of the file in error texts.

    Returns:
        The configuration.

    Raises:
        RouterConfigError: The text is not a valid configuration.
    """
    file = Table.parse(text, path)
    settings = file.table("router")
    dialect = settings.value("dialect", str, "all")
    try:
        names = Names(dialect)
    except DialectError as error:
        settings.refuse("dialect", f"{dialect!r}: {error}")
    endpoints = tuple(_endpoint(name, table, names) for name, table in file.named_tables("endpoint"))
    if len(endpoints) > MAX_ENDPOINTS:
        file.refuse("endpoint", f"has {len(endpoints)} tables; the maximum is {MAX_ENDPOINTS}")
    window = settings.converted("duplicate_window", duration, 0.0)
    if window > MAX_DUPLICATE_WINDOW:
        settings.refuse("duplicate_window", f"must be at most {MAX_DUPLICATE_WINDOW:g} s, got {window:g} s")
    config = RouterConfig(
        endpoints=endpoints,
        duplicate_window=window,
        control=_control(settings),
        control_token=settings.value("control_token", str, ""),
        metrics=settings.value("metrics", bool, default=True),
        watch=settings.value("watch", bool, default=True),
        dialect=dialect,
        firewall=file.table("firewall") if file.has("firewall") else None,
    )
    settings.finish()
    file.finish()
    if config.control and not config.control_token and not _LOOPBACK.fullmatch(config.control):
        settings.refuse(
            "control", f"{config.control} is reachable from other machines: set control_token too"
        )
    return config


def endpoint_from_values(name: str, values: Mapping[str, Any], dialect: str) -> EndpointConfig:
    """Read one endpoint from values, as the control API receives it.

    Args:
        name: Name of the endpoint.
        values: The keys and values of its table.
        dialect: Name of the dialect, or path of a definition file.

    Returns:
        The endpoint.

    Raises:
        RouterConfigError: A value is not valid.
    """
    table = Table.of({"endpoint": {name: dict(values)}}).table("endpoint").table(name)
    return _endpoint(name, table, Names(dialect))


def check_control(address: str, token: str) -> None:
    """Check host and port of a control API.

    Args:
        address: Host and port; empty: no control API.
        token: The token that its clients show; empty: none.

    Raises:
        ValueError: The address is not valid, or other machines reach it although there is no token.
    """
    match = _HOST_PORT.fullmatch(address)
    if address and (match is None or int(match[1]) > 65535):
        raise ValueError(f"a host and a port such as {DEFAULT_CONTROL}, got {address!r}")
    if address and not token and not _LOOPBACK.fullmatch(address):
        raise ValueError(f"an address of this machine such as {DEFAULT_CONTROL}, unless there is a token")


def _control(settings: Table) -> str:
    """Return host and port of the control API; empty: none."""

    def convert(value: object) -> str:
        if isinstance(value, bool):
            return DEFAULT_CONTROL if value else ""
        if not isinstance(value, str):
            raise ValueError(f"true, or a host and a port such as {DEFAULT_CONTROL!r}")
        check_control(value, settings.value("control_token", str, ""))
        return value

    return settings.converted("control", convert, "")


def _endpoint(name: str, table: Table, names: Names) -> EndpointConfig:
    if not _NAME.fullmatch(name):
        table.refuse("", "has a name with other characters than letters, digits, '_', '-' and '.'")
    record = _recording(table)
    url = table.value("url", str, "")
    if bool(url) == bool(record):
        table.refuse("", "needs either a url or a file to record" if url else "has no url")
    if url:
        _check_url(url, table)
    found = EndpointConfig(
        name=name,
        url=url,
        record=record,
        group=table.value("group", str, ""),
        listen_only=table.value("listen_only", bool, default=False),
        pause=table.value("pause", bool, default=False),
        rate=_positive(table, "rate", table.converted("rate", byte_rate, None)),
        rates=_rates(table.table("rates"), names),
        incoming=_filter(table.table("in"), names),
        outgoing=_filter(table.table("out"), names),
        high_latency=_high_latency(table),
        signing=read_signing(table.table("signing"), names) if table.has("signing") else None,
    )
    table.finish()
    if record is not None and found.signing is not None:
        table.refuse("signing", "has no effect on a recorder: leave it out")
    if record is not None and found.high_latency is not None:
        table.refuse("high_latency", "has no effect on a recorder: leave it out")
    return found


def _check_url(url: str, table: Table) -> None:
    """Refuse a URL that is malformed, or has options that its link or a router does not know."""
    from mavstack.links.registry import open_link

    try:
        link = open_link(url)
        check_link_settings(link)
        if link.settings.signing_key and table.has("signing"):
            table.refuse("signing", "and signing_key of the url both name keys: leave one out")
    except (LinkError, MissingExtraError) as error:
        table.refuse("url", f"is not usable: {error}")
    except OSError as error:
        table.refuse("url", f"is not usable: {error.filename}: {error.strerror}")


def _recording(table: Table) -> Recording | None:
    path = table.value("record", str, "")
    limits = {
        "max_size": table.converted("max_size", byte_size, None),
        "max_time": table.converted("max_time", duration, None),
        "keep": table.value("keep", int, 0) if table.has("keep") else None,
    }
    for key, limit in limits.items():
        if limit is not None and not path:
            table.refuse(key, "belongs to an endpoint with `record`")
        if limit is not None and limit <= 0:
            table.refuse(key, "must be positive")
    if limits["keep"] is not None and limits["max_size"] is None and limits["max_time"] is None:
        table.refuse("keep", "needs max_size or max_time")
    if not path:
        return None
    return Recording(path, **limits)  # type: ignore[arg-type]


def _high_latency(table: Table) -> float | None:
    def convert(value: object) -> float | None:
        if isinstance(value, bool):
            return DEFAULT_HIGH_LATENCY_INTERVAL if value else None
        try:
            return duration(value)
        except ValueError:
            raise ValueError("true, or the time between two messages such as '30 s'") from None

    return _positive(table, "high_latency", table.converted("high_latency", convert, None))


def _rates(table: Table, names: Names) -> tuple[tuple[int, float], ...]:
    rates: dict[int, float] = {}
    for key in table.names():
        try:
            message = names.message(int(key) if key.isascii() and key.isdigit() else key)
        except ValueError as error:
            table.refuse(key, f"is not a message: {error}")
        if message in rates:
            table.refuse(key, "is given twice, by name and by number")
        rates[message] = table.converted(key, hertz, 0.0)
        _positive(table, key, rates[message])
    return tuple(sorted(rates.items()))


def _filter(table: Table, names: Names) -> PacketFilter:
    kinds = {
        "messages": names.message,
        "systems": system,
        "components": names.component,
        "commands": names.command,
    }
    sets = {
        f"{verb}_{kind}": frozenset(table.members(f"{verb}_{kind}", convert))
        for kind, convert in kinds.items()
        for verb in ("allow", "deny")
    }
    table.finish()
    for kind in kinds:
        both = sets[f"allow_{kind}"] & sets[f"deny_{kind}"]
        if both:
            table.refuse(f"deny_{kind}", f"and allow_{kind} both have {min(both)}")
    return PacketFilter(**sets)


def _positive(table: Table, key: str, value: float | None) -> float | None:
    if value is not None and value <= 0:
        table.refuse(key, "must be positive; to send nothing, use listen_only or deny_messages")
    return value
