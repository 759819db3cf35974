"""The metrics of a router for Prometheus, read from the engine at each request; needs the extra `router`.

The counters of an endpoint are those of its open links: they start again when a connection is opened again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import MissingExtraError
from mavstack.router.endpoints import LISTENING, OPEN
from mavstack.router.snapshot import take_snapshot

try:
    from prometheus_client import CollectorRegistry, generate_latest
    from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
    from prometheus_client.registry import Collector
except ImportError as error:
    raise MissingExtraError("the metrics of the router", "router") from error

if TYPE_CHECKING:
    from collections.abc import Iterator

    from prometheus_client.core import Metric

    from mavstack.router.router import Router
    from mavstack.router.snapshot import Snapshot

_COUNTERS = {
    "received_packets": ("received", "Packets received"),
    "received_bytes": ("received_bytes", "Bytes received"),
    "sent_packets": ("sent", "Packets sent"),
    "sent_bytes": ("sent_bytes", "Bytes sent"),
    "bad_bytes": ("bad_bytes", "Received bytes that were no packets"),
    "bad_checksums": ("bad_crc", "Received packets with a wrong checksum"),
    "lost_packets": ("lost", "Packets missing in the sequence numbers of the sources"),
    "reconnections": ("reconnections", "Number of times that the endpoint was opened again"),
}


class RouterMetrics(Collector):
    """The metrics of one router, in a registry of their own.

    Args:
        router: The open router.
    """

    def __init__(self, router: Router) -> None:
        self._router = router
        self.registry = CollectorRegistry(auto_describe=False)
        self.registry.register(self)

    def text(self) -> bytes:
        """Return all metrics in the text format of Prometheus."""
        return generate_latest(self.registry)

    def collect(self) -> Iterator[Metric]:
        """Yield all metrics."""
        snapshot = take_snapshot(self._router)
        yield from _counters(snapshot)
        yield from _gauges(snapshot)
        alerts = CounterMetricFamily("mavstack_router_alerts", "Alerts of the firewall", labels=["detector"])
        for detector, count in self._router.attachments.guard.counts.items():
            alerts.add_metric([detector], count)
        yield alerts


def _counters(snapshot: Snapshot) -> Iterator[Metric]:
    for name, (attribute, text) in _COUNTERS.items():
        counter = CounterMetricFamily(f"mavstack_router_{name}", text, labels=["endpoint"])
        for endpoint in snapshot.endpoints:
            counter.add_metric([endpoint.name], getattr(endpoint, attribute))
        yield counter
    dropped = CounterMetricFamily(
        "mavstack_router_dropped_packets",
        "Packets that were not forwarded, by cause",
        labels=["endpoint", "cause"],
    )
    rules = CounterMetricFamily(
        "mavstack_router_rule_drops", "Packets that a rule dropped", labels=["endpoint", "rule"]
    )
    messages = CounterMetricFamily(
        "mavstack_router_message_packets",
        "Packets by message and direction",
        labels=["endpoint", "message", "direction"],
    )
    sources = CounterMetricFamily(
        "mavstack_router_source_packets",
        "Packets by source: received, and lost by its sequence numbers",
        labels=["endpoint", "source", "state"],
    )
    for endpoint in snapshot.endpoints:
        for cause, count in endpoint.dropped.items():
            dropped.add_metric([endpoint.name, cause], count)
        for rule, count in endpoint.rules.items():
            rules.add_metric([endpoint.name, rule], count)
        for message, (received, sent) in endpoint.messages.items():
            messages.add_metric([endpoint.name, message, "in"], received)
            messages.add_metric([endpoint.name, message, "out"], sent)
        for source, (received, lost) in endpoint.sources.items():
            sources.add_metric([endpoint.name, source, "received"], received)
            sources.add_metric([endpoint.name, source, "lost"], lost)
    yield from (dropped, rules, messages, sources)


def _gauges(snapshot: Snapshot) -> Iterator[Metric]:
    is_open = GaugeMetricFamily("mavstack_router_up", "1 if the endpoint is open", labels=["endpoint"])
    links = GaugeMetricFamily("mavstack_router_links", "Open links of the endpoint", labels=["endpoint"])
    queued = GaugeMetricFamily("mavstack_router_queued", "Packets or bytes that wait", labels=["endpoint"])
    for endpoint in snapshot.endpoints:
        is_open.add_metric([endpoint.name], float(endpoint.state in (OPEN, LISTENING)))
        links.add_metric([endpoint.name], len(endpoint.links))
        queued.add_metric([endpoint.name], endpoint.queued)
    routes = GaugeMetricFamily("mavstack_router_routes", "Learned addresses")
    routes.add_metric([], len(snapshot.routes))
    yield from (is_open, links, queued, routes)
