"""The configuration of a router: frozen dataclasses, compared by value.

Two configurations are compared key by key to find the steps of a reload (see `mavstack.router.changes`), so
everything here is hashable or compares by its content.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from mavstack.links.registry import resolve_url
from mavstack.router.config.signing import SigningConfig

if TYPE_CHECKING:
    from mavstack.router.config.tables import Table

#: Seconds between two HIGH_LATENCY2 messages with `high_latency = true`.
DEFAULT_HIGH_LATENCY_INTERVAL: Final = 5.0
#: Host and port of the control API with `control = true`.
DEFAULT_CONTROL: Final = "127.0.0.1:7272"


@dataclass(frozen=True, slots=True)
class PacketFilter:
    """The packets that one direction of an endpoint lets pass; an empty set sets no condition.

    Attributes:
        allow_messages: Only these messages pass.
        deny_messages: These messages are dropped.
        allow_systems: Only packets from these systems pass.
        deny_systems: Packets from these systems are dropped.
        allow_components: Only packets from these component ids pass.
        deny_components: Packets from these component ids are dropped.
        allow_commands: Of COMMAND_LONG and COMMAND_INT only those with these commands pass.
        deny_commands: COMMAND_LONG and COMMAND_INT with these commands are dropped.
    """

    allow_messages: frozenset[int] = frozenset()
    deny_messages: frozenset[int] = frozenset()
    allow_systems: frozenset[int] = frozenset()
    deny_systems: frozenset[int] = frozenset()
    allow_components: frozenset[int] = frozenset()
    deny_components: frozenset[int] = frozenset()
    allow_commands: frozenset[int] = frozenset()
    deny_commands: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True)
class Recording:
    """The file that an endpoint records to.

    Attributes:
        path: Path of the tlog or pcap file.
        max_size: Bytes of a file before the next one begins; None: no limit.
        max_time: Seconds of a file before the next one begins; None: no limit.
        keep: Number of newest files that are kept; None keeps all.
    """

    path: str
    max_size: int | None = None
    max_time: float | None = None
    keep: int | None = None


@dataclass(frozen=True, slots=True)
class EndpointConfig:
    """One endpoint.

    Attributes:
        name: Name of the endpoint.
        url: Link URL; empty for a recorder.
        record: The file of a recorder; None for a link.
        group: Name of the group of redundant links that this link belongs to; empty: none.
        listen_only: Packets from this endpoint are dropped; it only listens.
        pause: The endpoint is open, but no packet passes in either direction.
        rate: Maximum bytes per second to this endpoint; None: no limit.
        rates: Maximum rates to this endpoint in hertz, by message id, sorted.
        incoming: Filter of the packets from this endpoint.
        outgoing: Filter of the packets to this endpoint.
        high_latency: Seconds between HIGH_LATENCY2 messages, which replace the telemetry; None: off.
        signing: Its keys; None: those that the URL names.
    """

    name: str
    url: str = ""
    record: Recording | None = None
    group: str = ""
    listen_only: bool = False
    pause: bool = False
    rate: float | None = None
    rates: tuple[tuple[int, float], ...] = ()
    incoming: PacketFilter = PacketFilter()
    outgoing: PacketFilter = PacketFilter()
    high_latency: float | None = None
    signing: SigningConfig | None = None

    @property
    def location(self) -> str:
        """The URL without secrets, or the path of a recording."""
        return self.record.path if self.record is not None else resolve_url(self.url).redacted

    @property
    def keys(self) -> SigningConfig | None:
        """The keys, also those of `signing_key` in the URL; None: signatures pass unchanged."""
        key = resolve_url(self.url).options.get("signing_key", "") if self.url else ""
        return self.signing or (SigningConfig(key, key) if key else None)


@dataclass(frozen=True, slots=True)
class RouterConfig:
    """The configuration of a router.

    Attributes:
        endpoints: The endpoints in the order of the file.
        duplicate_window: Seconds within which an equal packet is dropped; 0: only within groups.
        control: Host and port of the control API; empty: no control API.
        control_token: Token that clients of the control API show; empty: none.
        metrics: The control API serves `/metrics` for Prometheus.
        watch: The file is loaded again when it changes.
        dialect: Name of the dialect, or path of a definition file.
        firewall: The table `[firewall]`; None without one.
    """

    endpoints: tuple[EndpointConfig, ...] = ()
    duplicate_window: float = 0.0
    control: str = ""
    control_token: str = field(default="", repr=False)
    metrics: bool = True
    watch: bool = True
    dialect: str = "all"
    firewall: Table | None = None

    def endpoint(self, name: str) -> EndpointConfig | None:
        """Return the endpoint of a name, or None."""
        return next((each for each in self.endpoints if each.name == name), None)
