"""The options of link URLs, recorded from the link classes while they are constructed.

Names, types and defaults come from the code; only the descriptions stand here. A test checks that they fit.
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
from mavstack.links.registry import BACKENDS, RADIOS
from mavstack.links.url import EXAMPLES, SEALED

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

Value = TypeVar("Value")

PURPOSES = {
    "udpin": "Listens on a UDP port; each sender is a channel. A multicast group as host is joined.",
    "udpout": "Sends to one UDP peer; broadcast and multicast addresses work.",
    "tcpin": "Accepts TCP connections; each is a channel.",
    "tcpout": "Connects to a TCP server, and again when the connection breaks.",
    "tls": "Connects to a TLS server.",
    "tlsin": "Accepts TLS connections, on request only from clients with a certificate.",
    "serial": "Opens a serial port; needs the extra `serial`.",
    "pty": "Makes a serial port for other programs of this machine; not on Windows.",
    "unix": "Connects to a Unix socket.",
    "unixin": "Accepts connections on a Unix socket.",
    "ws": "Connects to a WebSocket server; needs the extra `web`.",
    "wss": "Connects to a WebSocket server over TLS; needs the extra `web`.",
    "wsin": "Accepts WebSocket connections; needs the extra `web`.",
    "wssin": "Accepts WebSocket connections over TLS; needs the extra `web`.",
    "sealed+udpin": "Answers sealed UDP peers; needs the extra `secure`.",
    "sealed+udpout": "Connects to a sealed UDP link.",
    "sealed+tcpin": "Accepts sealed TCP connections.",
    "sealed+tcpout": "Connects to a sealed TCP link; `sealed+tcp` is the same.",
    "sealed+serial": "Seals a serial port; the URL is the same at both ends.",
    "file": "Replays a tlog or a file of raw packets.",
    "memory": "Connects nodes of one program; `MemoryNetwork` makes such links.",
}
DESCRIPTIONS = {
    "baud": "baud rate",
    "ca": "file with the authorities to trust; on a server: clients must show a certificate of theirs",
    "cert": "file with the own certificate",
    "framing": "length: each chunk of packets is preceded by its length, 4 bytes in big-endian order",
    "header.NAME": "a header to send, such as `header.X-Vehicle=7`",
    "flow": "flow control",
    "heartbeat_rate": "heartbeats of the node per second; 0: none",
    "id": "ids of the node: system or system/component",
    "half_duplex": "both directions share the bandwidth given by `pace`",
    "idle": "a peer that is silent for this long is closed; 0: never",
    "insecure": "do not verify the server's certificate (tests only)",
    "key": "file with the private key of `cert`",
    "cipher": "the cipher, equal at both ends",
    "hybrid": "add ML-KEM-768 to the key exchange, at both ends",
    "mtu": "bytes of a datagram to which waiting packets are joined",
    "peer": "public keys of the peers: digits, or a file with a line for each; an end that connects has one",
    "private_key": "file or name of the own key for sealed links",
    "shared_key": "file or name of a signing key that both ends have, from which the key is derived",
    "mavlink": "MAVLink version to send; auto: 1 to peers that are heard only in version 1",
    "trust_senders": "`no` (default in a router): a new peer gets three times what it sent until it answers",
    "max_peers": "peers at the same time; a new one replaces the idlest that sent no valid packet",
    "origin": "the Origin header to send, or, on a server, to require",
    "pace": "bandwidth of the link in bytes/s; transfers are paced to it",
    "query.NAME": "a field of the query string to send, such as `query.room=7`",
    "receive_queue": "received bytes that wait to be read; beyond it datagrams are dropped, streams wait",
    "reconnect": "connect again after the connection is lost",
    "retry": "delay before the first new attempt",
    "retry_limit": "longest delay between attempts",
    "send_queue": "bytes that wait to be sent; packets beyond it are dropped and counted",
    "server_name": "name that the server's certificate must have",
    "signing_key": "file or name of the key that signs and verifies",
    "socket_buffer": "size of the operating system's socket buffers",
    "speed": "1: as recorded, 10: ten times as fast, max: at once",
    "subprotocol": "subprotocols to offer, or, on a server, to accept: one or several, with commas",
    "threads": "read and write in threads instead of by the event loop",
    "ticket_key": "file or name of the key of tickets: a client makes one, a server requires one",
    "timeout": "time limit of one attempt to connect",
    "token": "the bearer token to show, or, on a server, to require; with `ticket_key` either is enough",
    "wait": "let `open` wait until the first attempt succeeds, instead of raising",
    # impairments
    "bandwidth": "bytes/s that the impaired link carries; 0: unlimited",
    "corrupt": "probability that a byte is changed",
    "duplicate": "probability that a packet arrives twice",
    "hold": "extra delay of a reordered packet",
    "jitter": "random part of the delay",
    "latency": "delay",
    "loss": "probability that a packet is lost",
    "queue": "bytes that wait in front of the limited bandwidth",
    "radio": "sik: a pair of SiK telemetry radios with RADIO_STATUS, `bandwidth` and `queue` are theirs",
    "reorder": "probability that a packet is delayed behind later ones",
    "role": "what clients may send at most: observe, operate or administer",
    "roles": "file with a line for each client: its role and its identity; others observe",
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
        kinds = {"id": "ids", "mavlink": "1, 2 or auto", "heartbeat_rate": "hertz"}
        self._note(name, kinds[name], "that of the node")
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
    module, name = BACKENDS[scheme].split(":")
    given = {"cert": "cert.pem"} if scheme in ("tlsin", "wssin") else {}
    url = LinkURL(scheme, host="127.0.0.1", port=1, path="/file", options=given)
    options = RecordingOptions(url)
    with suppress(MavstackError, OSError):  # the certificate does not exist: by then the options are read
        getattr(import_module(f"mavstack.links.{module}"), name)(url, options)
    if scheme.startswith(SEALED):
        names = options.read.keys() - impairment_options().keys()
        return {name: option for name, option in options.read.items() if name in names}
    return options_of("wsin") | options.read if scheme == "wssin" else options.read


def impairment_options() -> dict[str, Option]:
    """Return the options of impairments, by name."""
    options = RecordingOptions(LinkURL("udpout", host="127.0.0.1", port=1, options={"loss": "0.5"}))
    Impairment.from_options(options)
    options.choice("radio", RADIOS)
    return options.read


def render() -> str:
    """Return the tables of schemes and options."""
    shared = set.intersection(*(set(options_of(scheme)) for scheme in EXAMPLES if scheme != "memory"))
    lines = ["## Schemes", "", "| scheme | example | purpose |", "|---|---|---|"]
    lines += [f"| `{scheme}` | `{EXAMPLES[scheme]}` | {PURPOSES[scheme]} |" for scheme in EXAMPLES]
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
    for scheme in EXAMPLES:
        if scheme.startswith(SEALED):
            continue
        groups.setdefault(tuple(sorted(options_of(scheme))), []).append(scheme)
    return {", ".join(schemes): schemes for schemes in groups.values()}


def _table(options: Iterable[Option]) -> list[str]:
    rows = [
        f"| `{option.name}` | {option.type} | {option.default} | {DESCRIPTIONS[option.name]} |"
        for option in options
    ]
    return ["| option | type | default | meaning |", "|---|---|---|---|", *rows]


def _size(number: int) -> str:
    for unit, letter in ((1 << 20, "M"), (1 << 10, "k")):
        if number and number % unit == 0:
            return f"{number // unit}{letter}"
    return str(number)
