"""The firewall and the signing gateway of a running router: their rules and keys, given to the engine.

    guard = Guard(engine, config, rules_of)
    guard.open(now)
    guard.add(number, name, peer)                       a link was opened
    guard.configure(number, endpoint)                   its configuration, at first and when it changes
    guard.handle_event(event, now)                      each event of the engine
    guard.handle_timer(now)                             once a second
    guard.close()

Alerts are logged by `mavstack.router.firewall`, counted, passed to `on_alert`, and sent to ground stations as
STATUSTEXT if the configuration says so. Nothing here blocks or waits; the caller has the clock. The modules
of the firewall and of the gateway are imported when a configuration needs them.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import RouterConfigError, SigningError
from mavstack.router.config.names import Names
from mavstack.router.rules import RuleSet
from mavstack.wire import Encoder, Packet

if TYPE_CHECKING:
    from collections import Counter
    from collections.abc import Callable, Mapping

    from mavstack.dialects import Dialect
    from mavstack.router.config import EndpointConfig, RouterConfig
    from mavstack.router.engine import RouterEngine
    from mavstack.router.engine_events import RouterEvent
    from mavstack.router.firewall import Alert, Firewall
    from mavstack.router.firewall.id_store import IdStore
    from mavstack.router.gateway import Gateway
    from mavstack.router.peer import Peer
    from mavstack.security import TimestampStore

logger = logging.getLogger("mavstack.router.firewall")

#: System and component id of the router's status texts: a system id of ground stations, component UDP_BRIDGE.
OWN_ADDRESS: Final = (254, 240)
_NOTHING: Final = RuleSet(default_incoming="drop", default_outgoing="drop")


@dataclass(slots=True)
class _Link:
    """A link of the engine."""

    name: str
    peer: Peer | None
    listening: bool
    credential: str
    config: EndpointConfig | None = None


class Guard:
    """The firewall and the gateway of one router.

    Args:
        engine: The engine.
        config: The configuration of the router.
        rules_of: Returns the rules of an endpoint's own filter.
        timestamps: Returns the store of the signing timestamps for the next run; called when a key is used.
        ids: Returns the store of the assigned system ids for the next run; called when there is a firewall.

    Raises:
        RouterConfigError: The table `[firewall]` is not valid, or the assigned ids cannot be read.
    """

    def __init__(
        self,
        engine: RouterEngine,
        config: RouterConfig,
        rules_of: Callable[[EndpointConfig], RuleSet],
        timestamps: Callable[[], TimestampStore] | None = None,
        ids: Callable[[], IdStore] | None = None,
    ) -> None:
        names = Names(config.dialect)
        self._engine = engine
        self._dialect: Dialect = names.dialect
        self._rules_of = rules_of
        self._ids = ids
        self.firewall = _firewall(config, names, self._known_ids(config))
        self._stored_ids = self._assigned_ids()
        self._timestamps = timestamps
        self._gateway: Gateway | None = None
        #: Called with each alert.
        self.on_alert: Callable[[Alert], None] = lambda alert: None
        self._links: dict[int, _Link] = {}
        self._now = 0.0
        self._encoder = Encoder(*OWN_ADDRESS)
        self._own: int | None = None

    @property
    def counts(self) -> Counter[str] | Mapping[str, int]:
        """Number of alerts by detector or rule."""
        return {} if self.firewall is None else self.firewall.counts

    @property
    def needs_timer(self) -> bool:
        """True if `handle_timer` has something to do."""
        return self.firewall is not None or self._gateway is not None

    def open(self, now: float) -> None:
        """Open the endpoint that status texts come from.

        Args:
            now: Unix time in seconds.
        """
        self._now = now
        self._open_own()

    def _open_own(self) -> None:
        """Open the endpoint that status texts come from, or close it, as the configuration says."""
        wanted = self.firewall is not None and self.firewall.config.statustext
        if wanted and self._own is None:
            self._own = self._engine.add_queue(name="firewall", capacity=1, start=False)
            self._engine.set_rules(self._own, RuleSet(default_outgoing="drop"))
            self._engine.start(self._own)
        elif not wanted and self._own is not None:
            self._engine.remove(self._own)
            self._own = None

    def add(
        self, number: int, name: str, peer: Peer | None, *, listening: bool = False, credential: str = ""
    ) -> None:
        """Add a link, which nothing passes until `configure`.

        Args:
            number: Its number in the engine.
            name: Its name, which no other link has.
            peer: Address of its peer; None: it has none.
            listening: It is a UDP socket with any number of peers.
            credential: The verified identity of the peer; empty: none.
        """
        self._links[number] = _Link(name, peer, listening, credential)
        if credential:
            from mavstack.security.senders import Authority

            self._engine.set_authority(number, Authority.CERTIFICATE)

    def configure(self, number: int, config: EndpointConfig) -> None:
        """Set the rules and the keys of a link by the configuration of its endpoint.

        Raises:
            SigningError: A key cannot be read.
        """
        link = self._links.setdefault(number, _Link(config.name, None, listening=False, credential=""))
        was_signed, link.config = link.config is not None and link.config.keys is not None, config
        self._engine.set_rules(number, self._rules(link, config))
        if link.listening:
            self._admit_peers(number, config.name)
            self._block_peers(number, link)
        if (keys := config.keys) is not None or was_signed:
            self._open_gateway().apply(self._engine, number, keys, self._now)

    def _open_gateway(self) -> Gateway:
        if self._gateway is None:
            from mavstack.router.gateway import Gateway

            self._gateway = Gateway(self._timestamps)
        return self._gateway

    def _block_peers(self, number: int, link: _Link) -> None:
        """Cut off the peers of a listening UDP socket that are in quarantine."""
        if link.listening:
            known = self.firewall is not None and self.firewall.knows(link.name)
            blocked = self.firewall.blocked(link.name) if self.firewall is not None and known else ()
            self._engine.set_blocked_peers(number, blocked)

    def _admit_peers(self, number: int, endpoint: str) -> None:
        """Limit the peers of a listening UDP socket to those that the firewall allows."""
        if self.firewall is None:
            self._engine.set_allowed_peers(number, None)
            return
        from mavstack.router.firewall.compiler import ambiguous_rules, peer_ranges

        self._engine.set_allowed_peers(number, peer_ranges(self.firewall.config, endpoint))
        for rule in ambiguous_rules(self.firewall.config, endpoint):
            text = "endpoint %s: rule %s differs by peer; give these peers an endpoint of their own"
            logger.warning(text, endpoint, rule)

    def load_keys(self, config: RouterConfig) -> bool:
        """Read the keys of all endpoints.

        Args:
            config: The configuration.

        Returns:
            True if a key that was read before has changed; the caller configures all links then.

        Raises:
            SigningError: A key cannot be read; the keys in use stay.
        """
        signed = [keys for each in config.endpoints if (keys := each.keys)]
        return bool(signed) and self._open_gateway().load_keys(signed)

    def reload(self, config: RouterConfig) -> None:
        """Replace the firewall, whose quarantines stay; the caller configures all links afterwards.

        Args:
            config: The configuration.

        Raises:
            RouterConfigError: The table `[firewall]` is not valid, or the assigned ids cannot be read; the
                present firewall stays.
        """
        ids = {**self._known_ids(config), **self._assigned_ids()}
        replacement = _firewall(config, Names(config.dialect), ids)
        if self.firewall is not None and replacement is not None:
            replacement.inherit(self.firewall)
        self.firewall = replacement
        self._open_own()

    def remove(self, number: int) -> None:
        """Forget a link that was closed. Idempotent."""
        link = self._links.pop(number, None)
        if link is not None and self.firewall is not None:
            self.firewall.close_endpoint(link.name)

    def handle_event(self, event: RouterEvent, now: float) -> None:
        """Handle an event of the engine.

        Args:
            event: The event.
            now: Time in seconds.
        """
        match event:
            case ("inspect", token, number, raw, peer, verified):
                self._engine.decide(token, self._passes(number, raw, now, peer, verified=verified))
            case ("inspect_out", token, *_):
                self._engine.decide(token, passed=True)
            case ("closed", number, _):
                self.remove(number)
            case ("rule", number, key, name, False, dry_run):
                self._matched(number, key, name, dry_run=dry_run, now=now)
            case ("contested", number, (system, component, _)):
                self._log_contest(number, system, component)
                return
            case _:
                return
        self._report(now)

    def handle_timer(self, now: float) -> None:
        """Measure the links, end quarantines and store timestamps.

        Call it once a second while `needs_timer` is true, and before a configuration changes.

        Args:
            now: Unix time in seconds.
        """
        self._now = now
        if self.firewall is not None:
            self._measure(self.firewall, now)
            self.firewall.handle_timeout(now)
            self._report(now)
        if self._gateway is not None and self._gateway.is_store_due(now):
            self._store(self._gateway, running=True)

    def _measure(self, firewall: Firewall, now: float) -> None:
        from mavstack.router.firewall.measuring import measure_link

        for number, counters in self._engine.statistics().endpoints.items():
            if (link := self._links.get(number)) is not None:
                one_signer = not link.listening and _verifies(link.config)
                measure_link(firewall, link.name, counters, now, one_signer=one_signer)

    def close(self) -> None:
        """Store the timestamps for the last time. Idempotent."""
        if self._gateway is not None:
            self._store(self._gateway, running=False)

    def _rules(self, link: _Link, config: EndpointConfig) -> RuleSet:
        own = self._rules_of(config)
        if self.firewall is None:
            return own
        admitted = self.firewall.open_endpoint(
            link.name,
            link.peer,
            endpoint=config.name,
            own=own,
            listening=link.listening,
            group=config.group,
            credential=link.credential,
            verifies=_verifies(config),
        )
        if self._assigned_ids() != self._stored_ids:
            self._store_ids()
        return self._with_rules(link, own) if admitted else _NOTHING

    def _with_rules(self, link: _Link, own: RuleSet) -> RuleSet:
        assert self.firewall is not None  # noqa: S101 (the caller checked)
        return RuleSet(
            incoming=self.firewall.rules(link.name),
            outgoing=own.outgoing,
            default_incoming="drop",
            default_outgoing=own.default_outgoing,
            bytes_per_second=own.bytes_per_second,
        )

    def _passes(
        self, number: int, raw: bytes, now: float, peer: tuple[str, int] | None, *, verified: bool
    ) -> bool:
        link = self._links.get(number)
        if link is None or self.firewall is None:
            return False
        from mavstack.router.firewall.quarantine import Remote

        try:
            packet = Packet(raw, self._dialect)
        except ValueError:
            return False
        remote = Remote(*peer) if peer is not None else None
        return self.firewall.decide(link.name, packet, now, peer=remote, verified=verified)

    def _matched(
        self, number: int, key: tuple[int, int, int], rule: str, *, dry_run: bool, now: float
    ) -> None:
        link = self._links.get(number)
        if link is not None and self.firewall is not None:
            from mavstack.services import Address

            system, component, message = key
            source, text = Address(system, component), self._message(message)
            self.firewall.matched(link.name, rule, source, text, dry_run=dry_run, now=now)

    def _log_contest(self, number: int, system: int, component: int) -> None:
        link = self._links.get(number)
        text = (
            "several senders claim %d/%d, the last one on %s: packets for it go to the first one; "
            "give redundant links the same group"
        )
        logger.warning(text, system, component, link.name if link is not None else f"link {number}")

    def _report(self, now: float) -> None:
        """Raise the alerts, and give the engine the rules that changed by them."""
        if self.firewall is None:
            return
        changed = set(self.firewall.changed())
        for number, link in self._links.items():
            if link.name in changed and link.config is not None:
                self._engine.set_rules(number, self._with_rules(link, self._rules_of(link.config)))
                self._block_peers(number, link)
        for alert in self.firewall.alerts():
            logger.warning("%s", alert)
            self.on_alert(alert)
            if self._own is not None:
                self._engine.push(self._own, self._encoder.encode(alert.statustext(), now))

    def _assigned_ids(self) -> dict[str, int]:
        return {} if self.firewall is None else self.firewall.ids.ids

    def _known_ids(self, config: RouterConfig) -> dict[str, int]:
        return {} if self._ids is None or config.firewall is None else self._ids().load()

    def _store_ids(self) -> None:
        self._stored_ids = self._assigned_ids()
        try:
            if self._ids is not None:
                self._ids().store(self._stored_ids)
        except RouterConfigError as error:
            logger.error("%s", error)

    def _store(self, gateway: Gateway, *, running: bool) -> None:
        try:
            gateway.store(running=running)
        except SigningError as error:
            logger.error("%s", error)

    def _message(self, number: int) -> str:
        return self._dialect.name_of(number) if number in self._dialect else f"message {number}"


def _verifies(config: EndpointConfig | None) -> bool:
    return config is not None and config.keys is not None and bool(config.keys.incoming)


def check_firewall(config: RouterConfig) -> None:
    """Check the table `[firewall]` of a configuration.

    Args:
        config: The configuration.

    Raises:
        RouterConfigError: The table is not valid.
    """
    _firewall(config, Names(config.dialect), {})


def _firewall(config: RouterConfig, names: Names, ids: Mapping[str, int]) -> Firewall | None:
    if config.firewall is None:
        return None
    from mavstack.router.firewall import Firewall, read_firewall

    endpoints = [endpoint.name for endpoint in config.endpoints]
    return Firewall(read_firewall(config.firewall, names, endpoints), ids)
