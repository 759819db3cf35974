"""The options of link URLs, recorded from the link classes while they are constructed.

Names, types and defaults come from the code, meanings from the records of the schemes; only those of the
options of every scheme are here. A test checks that they fit.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, TypeVar

from mavstack.errors import MavstackError
from mavstack.links import LinkURL
from mavstack.links.impairment import Impairment
from mavstack.links.options import Options
from mavstack.links.registry import RADIOS
from mavstack.links.scheme_table import builtin_schemes
from mavstack.links.schemes.sealed import SEALED

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

Value = TypeVar("Value")

#: The options of every scheme, and those of impairments; the record of a scheme has its others.
DESCRIPTIONS = {
    "heartbeat_rate": "heartbeats of the node per second; 0: none",
    "id": "ids of the node: system or system/component",
    "half_duplex": "both directions share the bandwidth given by `pace`",
    "mavlink": "MAVLink version to send; auto: 1 to peers that are heard only in version 1",
    "pace": "bandwidth of the link in bytes/s; transfers are paced to it",
    "receive_queue": "received bytes that wait to be read; beyond it datagrams are dropped, streams wait",
    "send_queue": "bytes that wait to be sent; packets beyond it are dropped and counted",
    "signing_key": "file or name of the key that signs and verifies",
    # impairments
    "bandwidth": "bytes/s that the impaired link carries; 0: unlimited",
    "corrupt": "probability that a byte is changed",
    "duplicate": "probability that a packet arrives twice",
    "hold": "extra delay of a reordered packet",
    "impairment": "values of a modem: acoustic, acoustic-m64, acoustic-seatrac or iridium",
    "jitter": "random part of the delay",
    "latency": "delay",
    "loss": "probability that a packet is lost",
    "queue": "bytes that wait in front of the limited bandwidth",
    "radio": "sik: a pair of SiK telemetry radios with RADIO_STATUS, `bandwidth` and `queue` are theirs",
    "reorder": "probability that a packet is delayed behind later ones",
    "seed": "seed of the random numbers",
}


@dataclass(frozen=True)
class Option:
    """One option as the code reads it."""

    name: str
    type: str
    default: str


class RecordingOptions(Options):
    """Options that record what is read, with the default."""

    def __init__(self, url: LinkURL) -> None:
        super().__init__(url)
        self.read: dict[str, Option] = {}

    def _note(self, name: str, kind: str, default: object) -> None:
        self.read.setdefault(name, Option(name, kind, str(default)))

    def text(self, name: str, default: str = "") -> str:
        defaults = {"server_name": "the host", "signing_key": "that of the node"}
        self._note(name, "text", defaults.get(name, default or "none"))
        return super().text(name, default)

    def choice(self, name: str, choices: Sequence[str]) -> str:
        self._note(name, " or ".join(choices), choices[0])
        return super().choice(name, choices)

    def parsed(self, name: str, parse: Callable[[str], Value], expected: str) -> Value | None:
        of_the_node = {"id": "ids", "mavlink": "1, 2 or auto", "heartbeat_rate": "hertz"}
        default = "that of the node" if name in of_the_node else "none"
        self._note(name, of_the_node.get(name, expected), default)
        return super().parsed(name, parse, expected)

    def prefixed(self, prefix: str) -> dict[str, str]:
        self._note(f"{prefix}NAME", "text", "none")
        return super().prefixed(prefix)

    def flag(self, name: str, *, default: bool) -> bool:
        self._note(name, "yes or no", "yes" if default else "no")
        return super().flag(name, default=default)

    def integer(self, name: str, default: int, *arguments: int, **keywords: int) -> int:
        self._note(name, "integer", default)
        return super().integer(name, default, *arguments, **keywords)

    def seconds(self, name: str, default: float) -> float:
        self._note(name, "time", f"{default:g} s")
        return super().seconds(name, default)

    def size(self, name: str, default: int) -> int:
        self._note(name, "bytes", _size(default))
        return super().size(name, default)

    def fraction(self, name: str, default: float) -> float:
        self._note(name, "fraction", f"{default:g}")
        return super().fraction(name, default)


def options_of(scheme: str) -> dict[str, Option]:
    """Return the options that the link class of a scheme reads, by name."""
    record = builtin_schemes()[scheme]
    module, name = record.backend.split(":")
    given = {"cert": "cert.pem"} if record.listens and "cert" in record.options else {}
    given |= {"ticket": "room1", "secret": "00" * 32} if "ticket" in record.options else {}
    url = LinkURL(scheme, host="127.0.0.1", port=1, path="/file", options=given)
    options = RecordingOptions(url)
    with suppress(MavstackError, OSError):  # the certificate does not exist: by then the options are read
        getattr(import_module(module), name)(url, options)
    if scheme.startswith(SEALED):
        names = options.read.keys() - impairment_options().keys()
        return {name: option for name, option in options.read.items() if name in names}
    return options.read


def impairment_options() -> dict[str, Option]:
    """Return the options of impairments, by name."""
    options = RecordingOptions(LinkURL("udpout", host="127.0.0.1", port=1, options={"loss": "0.5"}))
    Impairment.from_options(options)
    options.choice("radio", RADIOS)
    return options.read


def render() -> str:
    """Return the tables of schemes and options."""
    shared = {name for name in options_of("udpin") if name in DESCRIPTIONS}
    lines = ["## Schemes", "", "| scheme | example | purpose |", "|---|---|---|"]
    lines += [f"| `{each.name}` | `{each.example}` | {each.purpose} |" for each in builtin_schemes().values()]
    lines += [
        "",
        "## Options of every scheme",
        "",
        *_table(options_of("udpin")[name] for name in sorted(shared)),
    ]
    for title, schemes in _groups().items():
        own = [option for name, option in sorted(options_of(schemes[0]).items()) if name not in shared]
        if own:
            lines += ["", f"## Options of {title}", "", *_table(own)]
    sealed = options_of(f"{SEALED}udpin")
    own = [option for name, option in sorted(sealed.items()) if name not in options_of("udpin")]
    lines += ["", "## Options of sealed links, beside those of the link behind the `+`", "", *_table(own)]
    lines += ["", "## Impairments of every scheme", "", *_table(impairment_options().values())]
    return "\n".join(lines)


def _groups() -> dict[str, list[str]]:
    """Return the schemes with equal options, by their names."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for scheme in builtin_schemes():
        if scheme.startswith(SEALED):
            continue
        groups.setdefault(tuple(sorted(options_of(scheme))), []).append(scheme)
    return {", ".join(schemes): schemes for schemes in groups.values()}


def meanings() -> dict[str, str]:
    """Return the meaning of each option."""
    own = (record.options for record in builtin_schemes().values())
    return {name: text for options in own for name, text in options.items()} | DESCRIPTIONS


def _table(options: Iterable[Option]) -> list[str]:
    texts = meanings()
    rows = [
        f"| `{option.name}` | {option.type} | {option.default} | {texts[option.name]} |" for option in options
    ]
    return ["| option | type | default | meaning |", "|---|---|---|---|", *rows]


def _size(number: int) -> str:
    for unit, letter in ((1 << 20, "M"), (1 << 10, "k")):
        if number and number % unit == 0:
            return f"{number // unit}{letter}"
    return str(number)
