"""The configuration of the firewall: the table `[firewall]` of a router's configuration.

    [firewall]
    default = "deny"                    # packets that no rule allows are dropped
    [[firewall.rule]]
    name = "pilot"
    from = ["10.1.0.0/16"]
    systems = [255]
    messages = ["HEARTBEAT", "COMMAND_LONG", "MANUAL_CONTROL"]
    action = "allow"

The first rule that matches decides. All conditions of a rule must hold; one that is left out always holds.
"""

from __future__ import annotations

from dataclasses import dataclass
from ipaddress import ip_address
from typing import TYPE_CHECKING, Final, Literal, TypeAlias, cast

from mavstack.router.config.names import system
from mavstack.router.config.quantities import duration, hertz
from mavstack.router.firewall.detector import DEFAULT_DETECTORS, Detector, detector_names, make_detector
from mavstack.router.firewall.sources import network, ports, system_range

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.router.config import Table
    from mavstack.router.config.names import Names
    from mavstack.router.firewall.sources import Network
    from mavstack.router.peer import Peer

Verdict: TypeAlias = Literal["allow", "deny", "tell"]
#: Maximum number of rules of a firewall.
MAX_RULES: Final = 1000
_NO_PORTS: Final = range(65536)


@dataclass(frozen=True, slots=True)
class FirewallRule:
    """One rule; an empty condition always holds.

    Attributes:
        name: Name in statistics and alerts.
        action: `allow` and `deny` decide; `tell` counts the packet, and the next rules decide.
        endpoints: Names of endpoints from which the packet comes.
        networks: Networks in which the peer is; never true for peers without an address.
        ports: Ports that the peer may have.
        systems: System ids of the sender.
        components: Component ids of the sender.
        targets: System ids of the target.
        messages: Message ids.
        commands: Commands of COMMAND_LONG and COMMAND_INT.
        rate: Packets per second that pass; more are dropped. None: no limit.
    """

    name: str
    action: Verdict = "allow"
    endpoints: frozenset[str] = frozenset()
    networks: tuple[Network, ...] = ()
    ports: range = _NO_PORTS
    systems: frozenset[int] = frozenset()
    components: frozenset[int] = frozenset()
    targets: frozenset[int] = frozenset()
    messages: frozenset[int] = frozenset()
    commands: frozenset[int] = frozenset()
    rate: float | None = None

    @property
    def names_peers(self) -> bool:
        """True if the rule has a condition for the address of the peer."""
        return bool(self.networks) or self.ports != _NO_PORTS

    def concerns(self, endpoint: str) -> bool:
        """Return whether the rule is for an endpoint.

        Args:
            endpoint: Name of the endpoint.

        Returns:
            True if the rule names it, or names no endpoints.
        """
        return not self.endpoints or endpoint in self.endpoints

    def concerns_peer(self, peer: Peer | None) -> bool:
        """Return whether the conditions for the address of the peer hold.

        Args:
            peer: The peer; None: it has no address.

        Returns:
            True if the rule has no such condition, or the peer meets it.
        """
        return not self.names_peers or (peer is not None and self._has(peer))

    def _has(self, peer: Peer) -> bool:
        try:
            address = ip_address(peer.host.partition("%")[0])
        except ValueError:
            return False
        known = getattr(address, "ipv4_mapped", None) or address
        inside = not self.networks or any(known in each for each in self.networks)
        return inside and peer.port in self.ports


@dataclass(frozen=True, slots=True)
class FirewallConfig:
    """The configuration of a firewall.

    Attributes:
        rules: The rules in their order. default: What happens to packets that no rule decides about: `allow`
            or `deny`. dry_run: Nothing is dropped; alerts are raised anyway. quarantine: Seconds for
            which a source that a detector refused is cut off; 0: only its packet is dropped. statustext:
            Alerts are sent to ground stations too. detectors: The detectors, with their options. pool: System
            ids that are assigned to ground stations by their credentials; empty: none.
    """

    rules: tuple[FirewallRule, ...] = ()
    default: Verdict = "deny"
    dry_run: bool = False
    quarantine: float = 0.0
    statustext: bool = False
    detectors: tuple[Detector, ...] = ()
    pool: range = range(0)


def read_firewall(table: Table, names: Names, endpoints: Iterable[str] = ()) -> FirewallConfig:
    """Read the table `[firewall]`.

    Args:
        table: The table.
        names: Names of messages, commands and components.
        endpoints: Names of the endpoints that exist; rules that name others are refused. Empty: any.

    Returns:
        The configuration.

    Raises:
        RouterConfigError: The table is not valid; the text has file and line.
    """
    known = frozenset(endpoints)
    rules = tuple(_rule(each, names, known, number) for number, each in enumerate(table.tables("rule"), 1))
    if len(rules) > MAX_RULES:
        table.refuse("rule", f"has {len(rules)} tables; the maximum is {MAX_RULES}")
    ids = table.table("ids")
    config = FirewallConfig(
        rules=rules,
        default=cast("Verdict", table.choice("default", ("deny", "allow"))),
        dry_run=table.value("dry_run", bool, default=False),
        quarantine=table.converted("quarantine", duration, 0.0),
        statustext=table.value("statustext", bool, default=False),
        detectors=_detectors(table, names),
        pool=ids.converted("pool", system_range, range(0)),
    )
    ids.finish()
    table.finish()
    return config


def _rule(table: Table, names: Names, endpoints: frozenset[str], number: int) -> FirewallRule:
    rule = FirewallRule(
        name=table.value("name", str, f"rule {number}"),
        action=cast("Verdict", table.choice("action", ("allow", "deny", "tell"))),
        endpoints=frozenset(table.members("endpoints", str)),
        networks=table.members("from", network),
        ports=table.converted("ports", ports, _NO_PORTS),
        systems=frozenset(table.members("systems", system)),
        components=frozenset(table.members("components", names.component)),
        targets=frozenset(table.members("targets", system)),
        messages=frozenset(table.members("messages", names.message)),
        commands=frozenset(table.members("commands", names.command)),
        rate=table.converted("rate", hertz, None),
    )
    table.finish()
    if endpoints and (unknown := sorted(rule.endpoints - endpoints)):
        table.refuse(
            "endpoints", f"names {unknown[0]!r}, which is no endpoint; known: {', '.join(sorted(endpoints))}"
        )
    if rule.rate is not None and (rule.rate <= 0 or rule.action != "allow"):
        table.refuse("rate", "must be positive, and belongs to a rule that allows")
    return rule


def _detectors(table: Table, names: Names) -> tuple[Detector, ...]:
    chosen = table.members("detectors", _known_detector) if table.has("detectors") else DEFAULT_DETECTORS
    options = table.table("detector")
    made = []
    for name in chosen:
        detector = make_detector(name)
        own = options.table(name)
        detector.configure(own)
        detector.use_dialect(names.dialect)
        own.finish()
        made.append(detector)
    options.finish()
    return tuple(made)


def _known_detector(name: object) -> str:
    if name not in detector_names():
        raise ValueError(f"there is no detector {name!r}; known: {', '.join(detector_names())}")
    make_detector(str(name))  # raises if the detector cannot be created: a firewall must not run without it
    return str(name)
