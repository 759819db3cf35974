"""The state of a router as plain values: for the control API, the metrics and the live picture."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass, field
from time import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mavstack.dialects import Dialect
    from mavstack.router.config import EndpointConfig
    from mavstack.router.engine_statistics import EndpointStatistics, RouterStatistics
    from mavstack.router.router import Router


@dataclass(slots=True)
class EndpointState:
    """One endpoint: its state, and the counters of all its links together.

    Attributes:
        name: Name of the endpoint.
        url: URL without secrets, or the path of a recording.
        state: "open", "listening", "down", "ended" or "failed".
        reason: The reason why it is not open.
        address: Host and port on which it listens, as text; empty: it does not listen on a port.
        group: Group of redundant links; empty: none.
        listen_only: Packets from it are dropped.
        pause: All packets from and to it are dropped.
        links: Names of the open links: clients of a server, peers of a UDP socket.
        reconnections: Number of times that it was opened again.
        received: Packets received.
        received_bytes: Bytes received.
        sent: Packets sent.
        sent_bytes: Bytes sent.
        queued: Packets or bytes that wait to be sent.
        bad_bytes: Received bytes that were no packets.
        bad_crc: Received packets with a wrong checksum.
        lost: Packets missing in the sequence numbers of the sources.
        dropped: Packets that were not forwarded, by cause.
        rules: Packets that rules dropped, by the names of the rules.
        messages: Received and sent packets by the name of the message.
        sources: Received and lost packets by source, such as `1/1`.
    """

    name: str
    url: str
    state: str
    reason: str = ""
    address: str = ""
    group: str = ""
    listen_only: bool = False
    pause: bool = False
    links: list[str] = field(default_factory=list)
    reconnections: int = 0
    received: int = 0
    received_bytes: int = 0
    sent: int = 0
    sent_bytes: int = 0
    queued: int = 0
    bad_bytes: int = 0
    bad_crc: int = 0
    lost: int = 0
    dropped: Counter[str] = field(default_factory=Counter)
    rules: Counter[str] = field(default_factory=Counter)
    messages: dict[str, tuple[int, int]] = field(default_factory=dict)
    sources: dict[str, tuple[int, int]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RouteState:
    """A learned address, the endpoints that lead to it, and the seconds since it was heard.

    Attributes:
        verified: An authenticated sender holds the address: others cannot claim it.
        contested: Several senders that are no redundant links claim it; only the first one gets its packets.
    """

    system: int
    component: int
    endpoints: tuple[str, ...]
    age: float
    verified: bool = False
    contested: bool = False


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of a router.

    Attributes:
        endpoints: All endpoints in the order of the configuration.
        routes: The learned routes.
        alerts: Age in seconds and text of the newest alerts of the firewall, oldest first.
    """

    endpoints: tuple[EndpointState, ...]
    routes: tuple[RouteState, ...]
    alerts: tuple[tuple[float, str], ...] = ()


def take_snapshot(router: Router) -> Snapshot:
    """Return the state of an open router."""
    statistics = router.statistics()
    owners = {number: name for name, each in router.endpoints.items() for number in each.numbers}
    endpoints = tuple(_endpoint(config, router, statistics) for config in router.config.endpoints)
    routes = tuple(
        RouteState(
            each.system,
            each.component,
            _names(each.endpoints, owners),
            each.age,
            each.verified,
            each.contested,
        )
        for each in sorted(statistics.routes, key=lambda route: (route.system, route.component))
    )
    now = time()
    alerts = tuple((max(now - at, 0.0), str(alert)) for at, alert in router.recent_alerts)
    return Snapshot(endpoints, routes, alerts)


def endpoint_values(endpoint: EndpointState) -> dict[str, Any]:
    """Return an endpoint as values for JSON."""
    return {name: getattr(endpoint, name) for name in EndpointState.__slots__}


def snapshot_values(snapshot: Snapshot) -> dict[str, Any]:
    """Return the state of a router as values for JSON."""
    return {
        "endpoints": [endpoint_values(each) for each in snapshot.endpoints],
        "routes": [asdict(each) for each in snapshot.routes],
        "alerts": [{"age": age, "text": text} for age, text in snapshot.alerts],
    }


def _names(numbers: Iterable[int], owners: Mapping[int, str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(owners[number] for number in numbers if number in owners))


def _endpoint(config: EndpointConfig, router: Router, statistics: RouterStatistics) -> EndpointState:
    found = EndpointState(
        config.name, config.location, "failed", router.problems.get(config.name, ""),
        group=config.group, listen_only=config.listen_only, pause=config.pause,
    )  # fmt: skip
    endpoint = router.endpoints.get(config.name)
    if endpoint is None:
        return found
    found.state, found.reason = endpoint.state, endpoint.reason
    found.address = endpoint.listens_on
    found.reconnections = endpoint.reconnections
    for number, name in endpoint.numbers.items():
        counted = statistics.endpoints.get(number)
        if counted is None:
            continue
        peers = [f"{name} {peer.host}:{peer.port}" for peer in counted.peers]
        found.links += peers or [name]
        _add(found, counted, router.attachments.dialect)
        if number in endpoint.sent:
            packets, size = endpoint.sent[number]
            found.sent += packets - counted.sent
            found.sent_bytes += size - counted.sent_bytes
        lost = endpoint.dropped.get(number, 0)
        if lost:
            found.dropped["slow_client"] += lost
    return found


def _add(found: EndpointState, counted: EndpointStatistics, dialect: Dialect) -> None:
    """Add the counters of one link."""
    for name in ("received", "received_bytes", "sent", "sent_bytes", "queued", "bad_bytes", "bad_crc"):
        setattr(found, name, getattr(found, name) + getattr(counted, name))
    found.dropped.update(counted.dropped)
    for rule in (*counted.incoming_rules, *counted.outgoing_rules):
        if rule.dropped:
            found.rules[rule.name or "unnamed"] += rule.dropped
    for number, (received, sent) in counted.messages.items():
        name = "unknown" if number is None else dialect.name_of(number)
        before = found.messages.get(name, (0, 0))
        found.messages[name] = before[0] + received, before[1] + sent
    for (system, component), source in counted.sources.items():
        name = f"{system}/{component}"
        before = found.sources.get(name, (0, 0))
        found.sources[name] = before[0] + source.received, before[1] + source.lost
        found.lost += source.lost
