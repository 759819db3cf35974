"""Statistics of the engine: counters of its endpoints, and the routes that it learned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any, Self


@dataclass(frozen=True, slots=True)
class SourceCounts:
    """The packets of one source on one endpoint."""

    received: int
    bytes: int
    lost: int
    late: int


@dataclass(frozen=True, slots=True)
class RuleCounts:
    """The packets that a rule matched, and those that it dropped, or would have dropped in a dry run."""

    name: str
    matched: int
    dropped: int


@dataclass(frozen=True, slots=True)
class PeerState:
    """A peer of a listening UDP socket.

    Attributes:
        host: Its IP address.
        port: Its port.
        age: Seconds since it was heard.
        accepted: Packets of it that were accepted.
        bad_bytes: Bytes of it outside packets; 0 where signatures are verified, since any program can send
            such bytes in its name.
    """

    host: str
    port: int
    age: float
    accepted: int = 0
    bad_bytes: int = 0


@dataclass(frozen=True, slots=True)
class EndpointStatistics:
    """The counters of one endpoint.

    `dropped` has the number of packets by cause: `rule_in`, `rule_out`, `rate`, `full_queue`, `not_sent`,
    `duplicate`, `loop`, `no_route`, `link_status`, `signing_key`, `listen_only`, `paused`, `spoofed`,
    `unsigned`, `forged`, `replayed`, `stale`, `future`, `too_many_streams`, `inspected`, `not_inspected`,
    `other_peer`, `too_many_peers`, `unanswered`. Causes that did not occur are absent. `messages` has
    received and sent packets by message id, None for messages that the dialect lacks. `radio_status` is the
    payload of the last RADIO_STATUS, or None. `queued` counts datagrams, bytes of a stream, or packets of a
    queue that wait to be sent.
    """

    name: str
    received: int
    received_bytes: int
    sent: int
    sent_bytes: int
    dropped: Mapping[str, int]
    incoming_rules: tuple[RuleCounts, ...]
    outgoing_rules: tuple[RuleCounts, ...]
    messages: Mapping[int | None, tuple[int, int]]
    sources: Mapping[tuple[int, int], SourceCounts]
    bad_bytes: int
    bad_crc: int
    unknown: int
    queued: int
    peers: tuple[PeerState, ...]
    radio_status: bytes | None


@dataclass(frozen=True, slots=True)
class Route:
    """A learned address, the endpoints that lead to it, and its age: seconds since it was heard.

    Attributes:
        verified: An authenticated sender holds the address: others cannot claim it.
        contested: Several senders that are no redundant links claim it.
    """

    system: int
    component: int
    endpoints: tuple[int, ...]
    verified: bool
    contested: bool
    age: float


@dataclass(frozen=True, slots=True)
class RouterStatistics:
    """The counters of all open endpoints by number, the learned routes, and the number of lost events."""

    endpoints: Mapping[int, EndpointStatistics]
    routes: tuple[Route, ...]
    dropped_events: int

    @classmethod
    def of(cls, counted: dict[str, Any], names: Mapping[int, str]) -> Self:
        """Return the statistics of the core, with the names of its endpoints."""
        endpoints = {
            number: _endpoint(names.get(number, str(number)), values)
            for number, values in counted["endpoints"].items()
        }
        routes = tuple(
            Route(system, component, tuple(numbers), verified, contested, age)
            for system, component, numbers, verified, contested, age in counted["routes"]
        )
        return cls(endpoints, routes, counted["dropped_events"])


def _endpoint(name: str, values: dict[str, Any]) -> EndpointStatistics:
    values["sources"] = {source: SourceCounts(*counts) for source, counts in values["sources"].items()}
    values["incoming_rules"] = tuple(RuleCounts(*counts) for counts in values["incoming_rules"])
    values["outgoing_rules"] = tuple(RuleCounts(*counts) for counts in values["outgoing_rules"])
    values["peers"] = tuple(PeerState(*peer) for peer in values["peers"])
    return EndpointStatistics(name=name, **values)
