"""Writing of configurations: `RouterConfig` to TOML, with names where the dialect has them."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from typing import TYPE_CHECKING, Final

from mavstack.router.config.model import EndpointConfig, PacketFilter, RouterConfig
from mavstack.router.config.names import Names
from mavstack.router.config.signing import UNSIGNED

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.router.config.signing import SigningConfig

_BARE_KEY: Final = re.compile(r"[A-Za-z0-9_-]+")
_SETTINGS: Final = ("duplicate_window", "control", "control_token", "metrics", "watch", "dialect")


def toml_text(config: RouterConfig) -> str:
    """Return a configuration as TOML that `parse_config` reads as an equal one.

    Args:
        config: The configuration; the table of its firewall is left out.
    """
    names = Names(config.dialect)
    default = RouterConfig()
    settings = [
        f"{name} = {_value(getattr(config, name))}"
        for name in _SETTINGS
        if getattr(config, name) != getattr(default, name)
    ]
    blocks = [["[router]", *settings]] if settings else []
    for endpoint in config.endpoints:
        blocks += _endpoint(endpoint, names)
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def _endpoint(endpoint: EndpointConfig, names: Names) -> Iterator[list[str]]:
    """Yield the tables of an endpoint, each as its lines."""
    place = f"endpoint.{_key(endpoint.name)}"
    default = EndpointConfig("")
    lines = [f"[{place}]"]
    if endpoint.record is not None:
        record = endpoint.record
        entries = (("record", record.path), ("max_size", record.max_size), ("max_time", record.max_time))
        lines += [f"{key} = {_value(value)}" for key, value in (*entries, ("keep", record.keep)) if value]
    for name in ("url", "group", "listen_only", "pause", "rate", "high_latency"):
        value = getattr(endpoint, name)
        if value != getattr(default, name):
            lines.append(f"{name} = {_value(value)}")
    yield lines
    if endpoint.rates:
        rates = [f"{names.message_name(message)} = {_value(rate)}" for message, rate in endpoint.rates]
        yield [f"[{place}.rates]", *rates]
    for direction, packet_filter in (("in", endpoint.incoming), ("out", endpoint.outgoing)):
        if packet_filter != PacketFilter():
            yield [f"[{place}.{direction}]", *_filter(packet_filter, names)]
    if endpoint.signing is not None:
        yield [f"[{place}.signing]", *_signing(endpoint.signing, names)]


def _filter(packet_filter: PacketFilter, names: Names) -> Iterator[str]:
    for each in fields(packet_filter):
        numbers = sorted(getattr(packet_filter, each.name))
        if numbers:
            by_name = each.name.endswith("_messages")
            members = [names.message_name(number) if by_name else number for number in numbers]
            yield f"{each.name} = [{', '.join(map(_value, members))}]"


def _signing(signing: SigningConfig, names: Names) -> Iterator[str]:
    for key, name in (("in", signing.incoming), ("out", signing.outgoing)):
        if name:
            yield f"{key} = {_value(name)}"
    if signing.allow_unsigned != UNSIGNED:
        unsigned = [_value(names.message_name(message)) for message in sorted(signing.allow_unsigned)]
        yield f"allow_unsigned = [{', '.join(unsigned)}]"
    if not signing.strip:
        yield "strip = false"


def _key(name: str) -> str:
    return name if _BARE_KEY.fullmatch(name) else _value(name)


def _value(value: object) -> str:
    if isinstance(value, float):
        return repr(int(value)) if value.is_integer() else f"{value:.9f}".rstrip("0")
    if not isinstance(value, str):
        return json.dumps(value)
    # JSON strings are valid TOML strings, except that TOML requires an escape for DEL.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
