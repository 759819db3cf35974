"""The rules of the firewall as rules of the engine, for one endpoint and its peer.

Conditions for the endpoint and its peer are decided here, once; the engine decides the others for each
packet. A rule with the action `tell` is a dry run of a denial. Packets for the detectors are inspected first:
the engine hands them over, and `decide` applies the same rules to them in Python.
"""

from __future__ import annotations

from dataclasses import replace
from ipaddress import ip_network
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from mavstack.dialects import common
from mavstack.router.rules import Rule, RuleSet
from mavstack.services import message_ids

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.router.firewall.config import FirewallConfig, FirewallRule
    from mavstack.router.peer import Peer
    from mavstack.wire import Packet

#: The prefix of the firewall's rule names in the engine's statistics.
PREFIX: Final = "firewall."
EVERYWHERE: Final = (ip_network("0.0.0.0/0"), ip_network("::/0"))
#: Network address, prefix length, first and last port.
PeerRange: TypeAlias = tuple[str, int, int, int]
DEFAULT_NAME: Final = f"{PREFIX}default"
_COMMANDS: Final = message_ids(common.CommandLong, common.CommandInt)


def engine_rules(
    config: FirewallConfig, endpoint: str, peer: Peer | None, *, listening: bool = False
) -> tuple[Rule, ...]:
    """Return the rules for the packets of one endpoint, without the inspection.

    Args:
        config: The configuration.
        endpoint: Name of the endpoint.
        peer: Its peer; None: it has no address.
        listening: The endpoint is a UDP socket with any number of peers, limited to `peer_ranges`.

    Returns:
        The rules; the last one decides about all packets that are left.
    """
    concerned = [rule for rule in config.rules if rule.concerns(endpoint)]
    if listening:
        chosen = _of_all_peers(concerned)
    else:
        chosen = [rule for rule in concerned if rule.concerns_peer(peer)]
    rules = [_compiled(rule, config.dry_run) for rule in chosen]
    if config.default == "deny":
        rules.append(Rule("drop", name=DEFAULT_NAME, dry_run=config.dry_run))
    return (*rules, Rule("pass", name=f"{PREFIX}pass"))


def with_filter(rules: Sequence[Rule], endpoint: RuleSet) -> tuple[Rule, ...]:
    """Return rules that pass a packet only if the filter of its endpoint passes it too.

    The rule of the filter that matches a packet first decides; where it passes, the rules decide.

    Args:
        rules: The rules of the firewall; the last one decides about all packets that are left.
        endpoint: The rules of the endpoint's own filter.

    Returns:
        The rules for both.
    """
    combined: list[Rule] = []
    for each in (*endpoint.incoming, Rule(endpoint.default_incoming)):
        if each.action == "drop" or each.dry_run:
            combined.append(each)
        else:
            combined += [both for rule in rules if (both := _both(rule, each)) is not None]
    return tuple(combined)


def admits(rules: Sequence[Rule]) -> bool:
    """Return whether any packet can pass.

    Args:
        rules: The rules of an endpoint.

    Returns:
        False if they drop everything, so that a connection can be refused.
    """
    for rule in rules:
        if rule.action == "pass":
            return True
        if not rule.dry_run and not _has_conditions(rule):
            return False
    return True


def peer_ranges(config: FirewallConfig, endpoint: str) -> list[PeerRange] | None:
    """Return the addresses that may be peers of a listening UDP socket.

    Args:
        config: The configuration.
        endpoint: Name of the endpoint.

    Returns:
        Network address, prefix length, first and last port of each range; None: all.
    """
    allowing = [rule for rule in config.rules if rule.action == "allow" and rule.concerns(endpoint)]
    if config.dry_run or config.default == "allow" or not all(rule.names_peers for rule in allowing):
        return None
    ranges: dict[PeerRange, None] = {}
    for rule in allowing:
        for each in rule.networks or EVERYWHERE:
            ranges[str(each.network_address), each.prefixlen, rule.ports[0], rule.ports[-1]] = None
    return list(ranges)


def ambiguous_rules(config: FirewallConfig, endpoint: str) -> list[str]:
    """Return the rules that cannot be decided for the peers of one UDP socket, because they differ.

    Args:
        config: The configuration.
        endpoint: Name of a listening UDP endpoint.

    Returns:
        The names of the rules. Those that allow are left out, those that deny hold for all peers.
    """
    concerned = [rule for rule in config.rules if rule.concerns(endpoint)]
    known = _of_all_peers(concerned)
    return [
        rule.name for rule in concerned if rule not in known or (rule.action == "deny" and rule.names_peers)
    ]


def inspection(messages: frozenset[int] | None) -> tuple[Rule, ...]:
    """Return the rule that hands packets to the detectors.

    Args:
        messages: Ids of the messages; None: all.

    Returns:
        One rule, or none if there is nothing to inspect.
    """
    if messages is not None and not messages:
        return ()
    return (Rule("inspect", messages=messages or frozenset(), name=f"{PREFIX}inspect"),)


def matches(rule: Rule, packet: Packet) -> bool:
    """Return whether a packet meets all conditions of a rule, as the engine decides it.

    Args:
        rule: The rule.
        packet: The packet.

    Returns:
        True if all conditions hold.
    """
    return (
        (not rule.messages or packet.message_id in rule.messages)
        and (not rule.systems or packet.system in rule.systems)
        and (not rule.components or packet.component in rule.components)
        and (not rule.target_systems or getattr(packet.message, "target_system", 0) in rule.target_systems)
        and (not rule.commands or _command(packet) in rule.commands)
    )


def deciding_rule(rules: Sequence[Rule], packet: Packet) -> tuple[Rule | None, list[Rule]]:
    """Return the rule that decides about a packet, and the dry runs that matched before it.

    Args:
        rules: The rules in their order.
        packet: The packet.

    Returns:
        The rule, None if none matched, and the dry runs.
    """
    dry_runs: list[Rule] = []
    for rule in rules:
        if not matches(rule, packet):
            continue
        if not rule.dry_run:
            return rule, dry_runs
        dry_runs.append(rule)
    return None, dry_runs


def _compiled(rule: FirewallRule, dry_run: bool) -> Rule:
    compiled = Rule(
        "pass" if rule.action == "allow" else "drop",
        messages=rule.messages,
        systems=rule.systems,
        components=rule.components,
        target_systems=rule.targets,
        commands=rule.commands,
        rate=None if dry_run else rule.rate,
        name=f"{PREFIX}{rule.name}",
    )
    is_dry = rule.action == "tell" or (dry_run and rule.action == "deny")
    return replace(compiled, dry_run=True) if is_dry else compiled


def _of_all_peers(rules: Sequence[FirewallRule]) -> list[FirewallRule]:
    """Return the rules of a listening socket: conditions for peers hold if those that allow share them."""
    allowing = {(rule.networks, rule.ports) for rule in rules if rule.action == "allow"}
    return [
        rule
        for rule in rules
        if not rule.names_peers or rule.action == "deny" or allowing == {(rule.networks, rule.ports)}
    ]


def _both(rule: Rule, other: Rule) -> Rule | None:
    """Return a rule with its conditions and those of another one; None if no packet meets both."""
    names = ("messages", "systems", "components", "target_systems", "commands")
    conditions: dict[str, Any] = {}
    for name in names:
        one, two = getattr(rule, name), getattr(other, name)
        conditions[name] = one & two if one and two else one | two
        if one and two and not conditions[name]:
            return None
    return replace(rule, **conditions)


def _has_conditions(rule: Rule) -> bool:
    return bool(rule.messages or rule.systems or rule.components or rule.target_systems or rule.commands)


def _command(packet: Packet) -> int | None:
    """Return the command of a packet; None if it has none, or its dialect lacks the message."""
    if packet.message_id not in _COMMANDS or packet.message is None:
        return None
    return int(packet.message.command)
