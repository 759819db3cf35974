"""The firewall: which packets of which peers pass, and the alerts. Sans-IO.

    firewall.open_endpoint(name, peer)        an endpoint with its peer; False: no rule allows it anything
    firewall.rules(name)                      its rules, for the engine
    firewall.decide(name, packet, now)        a packet that the engine hands over: True passes it
    firewall.measure(name, traffic, now)      the counters of an endpoint, once a second
    firewall.handle_timeout(now)              ends quarantines
    firewall.alerts()                         what was noticed since the last call
    firewall.changed()                        the endpoints whose rules changed, by quarantine

The driver gives the rules to the engine, logs the alerts, counts them and sends them as STATUSTEXT if the
configuration says so.
"""

from __future__ import annotations

import logging
from collections import Counter, deque
from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidStateError
from mavstack.router.firewall.alerts import Alert, AlertLimiter
from mavstack.router.firewall.bucket import TokenBucket
from mavstack.router.firewall.compiler import (
    PREFIX,
    admits,
    deciding_rule,
    engine_rules,
    inspection,
    with_filter,
)
from mavstack.router.firewall.detector import Origin, make_room, messages_of
from mavstack.router.firewall.ids import IdAssignment
from mavstack.router.firewall.quarantine import Quarantined, Remote, quarantine_rule
from mavstack.router.rules import Rule, RuleSet
from mavstack.security.senders import Authority, Sender
from mavstack.services import Address
from mavstack.wire import Packet

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from mavstack.router.firewall.config import FirewallConfig
    from mavstack.router.firewall.detector import Detector, Traffic
    from mavstack.router.peer import Peer

logger = logging.getLogger("mavstack.router.firewall")

#: Maximum number of alerts that wait until they are handled; the oldest ones are dropped.
MAX_ALERTS: Final = 1000
#: Maximum number of sources in quarantine per endpoint.
MAX_QUARANTINED: Final = 64
#: Maximum number of peers in quarantine per listening socket.
MAX_BLOCKED: Final = 1024


@dataclass(slots=True)
class _Endpoint:
    origin: str
    credential: str
    rules: tuple[Rule, ...]
    buckets: dict[int, TokenBucket] = field(default_factory=dict)
    group: str = ""
    listening: bool = False
    verifies: bool = False
    #: End time of each quarantine: of an address, of the whole link (None), or of a peer.
    quarantine: dict[Quarantined, float] = field(default_factory=dict)


class Firewall:
    """The firewall of one router.

    Args:
        config: Its configuration.
        ids: Assigned system ids of an earlier run, by credential.
    """

    def __init__(self, config: FirewallConfig, ids: Mapping[str, int] | None = None) -> None:
        self.config = config
        self.ids = IdAssignment(config.pool, ids)
        #: Number of alerts of each detector, for metrics.
        self.counts: Counter[str] = Counter()
        self._endpoints: dict[str, _Endpoint] = {}
        self._inspected = messages_of(config.detectors)
        self._limiter = AlertLimiter()
        self._alerts: deque[Alert] = deque(maxlen=MAX_ALERTS)
        self._changed: set[str] = set()
        #: Quarantines from before a reload, by endpoint; applied when the endpoint is added again.
        self._inherited: dict[str, dict[Quarantined, float]] = {}

    def inherit(self, previous: Firewall) -> None:
        """Take over the counts and the quarantines of the firewall that this one replaces.

        Without this, a reload would release every sender that is cut off. A firewall without `quarantine`,
        or with `dry_run`, takes over the counts only.

        Args:
            previous: The firewall in use until now.
        """
        self.counts.update(previous.counts)
        if self.config.quarantine and not self.config.dry_run:
            known = {name: each.quarantine for name, each in previous._endpoints.items()}
            self._inherited = previous._inherited | known

    def open_endpoint(
        self,
        name: str,
        peer: Peer | None = None,
        *,
        endpoint: str = "",
        own: RuleSet | None = None,
        listening: bool = False,
        group: str = "",
        credential: str = "",
        verifies: bool = False,
    ) -> bool:
        """Add an endpoint.

        Args:
            name: Name of the link, which no other one has.
            endpoint: Name of the endpoint in the configuration; empty: that of the link.
            own: The rules of the endpoint's own filter, which must pass a packet too.
            peer: Address of its peer; None: it has none, as a serial port.
            listening: It is a UDP socket with any number of peers (see `peer_ranges`).
            group: Name of its group of redundant links; empty: none.
            credential: The verified identity of the peer; it gets a system id of the pool.
            verifies: Signatures are verified: packets without one cause no quarantine.

        Returns:
            False if no rule allows this peer anything, or no system id is left for its credential: its
            connection should be refused.
        """
        rules = engine_rules(self.config, endpoint or name, peer, listening=listening)
        if own is not None:
            rules = with_filter(rules, own)
        refusal = self._refusal_of(rules, peer, credential)
        if refusal is not None:
            self.close_endpoint(name)  # remove the earlier rules of this endpoint
            detector, text = refusal
            self._raise(Alert(detector, name, None, text), 0.0)
            return False
        known = self._endpoints.get(name)
        quarantine = self._inherited.pop(name, {}) if known is None else known.quarantine
        self._endpoints[name] = _Endpoint(
            group or name,
            credential,
            rules,
            group=group,
            listening=listening,
            verifies=verifies,
            quarantine=quarantine,
        )
        return True

    def _refusal_of(
        self, rules: Sequence[Rule], peer: Peer | None, credential: str
    ) -> tuple[str, str] | None:
        """Return the detector and the reason for which an endpoint is not admitted; give it a system id."""
        if not admits(rules):
            place = f"a peer at {peer.host}:{peer.port}" if peer else "this endpoint"
            return "peers", f"no rule allows {place}"
        try:
            if credential and self.config.pool:
                self.ids.assign(credential)
        except InvalidStateError as error:
            return "ids", str(error)
        return None

    def close_endpoint(self, name: str) -> None:
        """Remove an endpoint. Idempotent.

        Args:
            name: Its name.
        """
        self._endpoints.pop(name, None)
        self._inherited.pop(name, None)
        self._changed.discard(name)

    def knows(self, name: str) -> bool:
        """Return whether an endpoint is open, and admitted.

        Args:
            name: Its name.
        """
        return name in self._endpoints

    def rules(self, name: str) -> tuple[Rule, ...]:
        """Return the rules of an endpoint for the engine: quarantine, inspection, and its own.

        Args:
            name: Name of the endpoint.

        Returns:
            The rules for packets that come from the endpoint.
        """
        endpoint = self._endpoints[name]
        cut_off = [source for source in endpoint.quarantine if not isinstance(source, Remote)]
        quarantine = tuple(quarantine_rule(source) for source in cut_off)
        foreign = frozenset() if not self.config.pool else frozenset(self.config.pool)
        guarded = (Rule("inspect", systems=foreign, name=f"{PREFIX}ids"),) if foreign else ()
        return (*quarantine, *inspection(self._inspected), *guarded, *endpoint.rules)

    def blocked(self, name: str) -> list[Remote]:
        """Return the peers of a listening socket that are in quarantine.

        Args:
            name: Name of the endpoint.

        Returns:
            Their remote addresses.
        """
        return [source for source in self._endpoints[name].quarantine if isinstance(source, Remote)]

    def decide(
        self, name: str, packet: Packet, now: float, *, peer: Remote | None = None, verified: bool = False
    ) -> bool:
        """Decide about a packet that the engine handed over.

        Args:
            name: Name of the endpoint that it came from.
            packet: The packet.
            now: Time in seconds.
            peer: The remote address of its sender, if that is a peer of a listening socket.
            verified: It has a valid signature.

        Returns:
            True to pass the packet, False to drop it.
        """
        endpoint = self._endpoints.get(name)
        if endpoint is None:
            return False
        if not self._rules_pass(endpoint, packet, now):
            return False
        origin = _origin(name, endpoint, peer, verified=verified)
        refusal = self._first_refusal(endpoint, origin, self._as_common(packet), now)
        if refusal is None or self.config.dry_run:
            return True
        # With verified signatures, an unsigned packet causes no quarantine: its addresses may be forged.
        if self.config.quarantine and (verified or not endpoint.verifies):
            # A quarantine by system id needs a proven identity, or a link with only one sender.
            by_ids = origin.sender.is_authenticated or peer is None
            self._cut_off(name, refusal.source if by_ids else peer, now)
        return False

    def _as_common(self, packet: Packet) -> Packet:
        """Return a packet of a custom dialect as the same one of `common`, which the detectors know."""
        name, message = packet.name, packet.message
        if (
            message is None
            or name is None
            or name not in common.dialect
            or isinstance(message, common.dialect[name])
        ):
            return packet
        try:
            return Packet(packet.raw, common)
        except ValueError:  # the dialect defines another message with this name
            return packet

    def matched(
        self, name: str, rule: str, source: Address, message: str, *, dry_run: bool, now: float
    ) -> None:
        """Take note of a packet that the engine dropped by a rule of the firewall, or would have dropped.

        Args:
            name: Name of the link.
            rule: Name of the rule in the engine.
            source: The sender.
            message: Name or id of the message.
            dry_run: The packet was not dropped.
            now: Time in seconds.
        """
        endpoint = self._endpoints.get(name)
        if endpoint is not None and rule.startswith(PREFIX):
            verb = "would be dropped" if dry_run else "dropped"
            text = f"{message} {verb} by this rule"
            self._raise(Alert(rule, endpoint.origin, source, text, refuse=not dry_run), now)

    def measure(self, name: str, traffic: Traffic, now: float, *, peer: Remote | None = None) -> None:
        """Look at the counters of an endpoint, or of one peer of a listening socket.

        A listening socket receives datagrams of any sender, so its own counters cut nothing off.

        Args:
            name: Name of the endpoint.
            traffic: Its counters, or those of the peer.
            now: Time in seconds.
            peer: The remote address of the peer; None: the whole endpoint.
        """
        endpoint = self._endpoints.get(name)
        if endpoint is None:
            return
        origin = name if peer is None else f"{name} {peer}"
        for detector in self.config.detectors:
            for alert in self._measured(detector, origin, traffic, now):
                self._raise(alert, now)
                cuts_off = peer is not None or not endpoint.listening
                if cuts_off and self.config.quarantine and not self.config.dry_run:
                    self._cut_off(name, peer, now)

    @staticmethod
    def _measured(detector: Detector, name: str, traffic: Traffic, now: float) -> list[Alert]:
        try:
            return list(detector.measure(name, traffic, now))
        except Exception:  # a defect must not stop the router, as in `_detected`
            logger.exception("detector %s failed", detector.name)
            return []

    def handle_timeout(self, now: float) -> None:
        """End the quarantines whose time is over.

        Args:
            now: Time in seconds.
        """
        for name, endpoint in self._endpoints.items():
            ended = [source for source, end in endpoint.quarantine.items() if now >= end]
            for source in ended:
                del endpoint.quarantine[source]
                self._changed.add(name)

    def changed(self) -> list[str]:
        """Return the names of the endpoints whose rules changed since the last call."""
        changed, self._changed = sorted(self._changed), set()
        return changed

    def alerts(self) -> list[Alert]:
        """Return the alerts since the last call; repeated ones are counted, not returned again."""
        alerts = list(self._alerts)
        self._alerts.clear()
        return alerts

    def _rules_pass(self, endpoint: _Endpoint, packet: Packet, now: float) -> bool:
        rule, dry_runs = deciding_rule(endpoint.rules, packet)
        source = Address(packet.system, packet.component)
        dropped = rule is not None and (rule.action == "drop" or self._is_over_rate(endpoint, rule, now))
        for each in [*dry_runs, *([rule] if rule is not None and dropped else [])]:
            reason = "over its rate" if each.action == "pass" else "by this rule"
            text = f"{packet.name or packet.message_id} dropped {reason}"
            text = text.replace("dropped", "would be dropped") if each.dry_run else text
            self._raise(Alert(each.name, endpoint.origin, source, text, refuse=not each.dry_run), now)
        return not dropped

    @staticmethod
    def _is_over_rate(endpoint: _Endpoint, rule: Rule, now: float) -> bool:
        if rule.rate is None:
            return False
        bucket = endpoint.buckets.setdefault(id(rule), TokenBucket(rule.rate, now))
        return not bucket.take(now)

    def _first_refusal(self, endpoint: _Endpoint, origin: Origin, packet: Packet, now: float) -> Alert | None:
        """Raise the alerts about a packet; no detector learns from one that is refused."""
        for alert in chain(self._id_alerts(endpoint, packet), self._detected(origin, packet, now)):
            self._raise(alert, now)
            if alert.refuse:
                return alert
        return None

    def _id_alerts(self, endpoint: _Endpoint, packet: Packet) -> Iterable[Alert]:
        reason = self.ids.refusal(endpoint.credential, packet.system)
        if reason is not None:
            yield Alert("ids", endpoint.origin, Address(packet.system, packet.component), reason)

    def _detected(self, origin: Origin, packet: Packet, now: float) -> Iterable[Alert]:
        for detector in self.config.detectors:
            if not (detector.every_packet or packet.message_id in detector.messages):
                continue
            try:
                yield from detector.inspect(origin, packet, now)
            except Exception:  # a defect of a detector must not let the packet pass, nor stop the router
                logger.exception("detector %s failed", detector.name)
                yield detector.alert(origin, packet, "the detector failed, see the log")

    def _raise(self, alert: Alert, now: float) -> None:
        self.counts[alert.detector] += 1
        limited = self._limiter.limited(alert, now)
        if limited is not None:
            self._alerts.append(limited)

    def _cut_off(self, name: str, source: Quarantined, now: float) -> None:
        quarantine = self._endpoints[name].quarantine
        if isinstance(source, Remote):
            make_room(quarantine, MAX_BLOCKED)  # ends the oldest quarantines: peers can invent addresses
        elif source not in quarantine and len(quarantine) >= MAX_QUARANTINED:
            if self._endpoints[name].listening:
                return  # no quarantine of the socket, since other peers use it; only the packet is dropped
            source = None  # so many sources on one link must be forged: put the whole link in quarantine
        if source not in quarantine:
            self._changed.add(name)
        quarantine[source] = now + self.config.quarantine


def _origin(name: str, endpoint: _Endpoint, peer: Remote | None, *, verified: bool) -> Origin:
    """Return the origin of a packet: the endpoint or its group, and the sender."""
    proof = Authority.KEY if verified else Authority.CERTIFICATE if endpoint.credential else Authority.NONE
    remote = str(peer) if peer is not None else ""
    return Origin(endpoint.origin, Sender(name, remote, proof, endpoint.credential, endpoint.group))
