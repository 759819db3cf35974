"""The filters of an endpoint as rules of the engine.

A filter has conditions that all must hold; the engine has ordered rules of which the first that matches
decides. A denied packet is therefore dropped by a rule of its own before anything passes; the packets that
pass are described by one rule with all conditions, or by the default if there are none. A rate is a rule that
passes its message as often as it says; it has the other conditions too, so that it passes nothing that they
would drop.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.router.config.names import COMMAND_MESSAGES
from mavstack.router.rules import Rule, RuleSet

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.router.config import EndpointConfig, PacketFilter
    from mavstack.router.rules import Action


def rules_of(
    endpoint: EndpointConfig, incoming: tuple[Rule, ...] = (), outgoing: tuple[Rule, ...] = ()
) -> RuleSet:
    """Return the rules of an endpoint.

    Args:
        endpoint: The configuration of the endpoint.
        incoming: Rules that decide before the filter of packets from the endpoint, such as a firewall's.
        outgoing: Rules that decide before the filter of packets to the endpoint.
    """
    in_rules, in_default = _compile(endpoint.incoming, "in", ())
    out_rules, out_default = _compile(endpoint.outgoing, "out", endpoint.rates)
    return RuleSet(
        incoming=(*incoming, *in_rules),
        outgoing=(*outgoing, *out_rules),
        default_incoming=in_default,
        default_outgoing=out_default,
        bytes_per_second=endpoint.rate,
    )


def _compile(
    packet_filter: PacketFilter, direction: str, rates: tuple[tuple[int, float], ...]
) -> tuple[tuple[Rule, ...], Action]:
    """Return the rules of one direction, and what happens to packets that match none."""
    allowed = packet_filter
    denials = tuple(_denials(packet_filter, direction))
    limited = tuple(
        Rule("pass", frozenset({message}), allowed.allow_systems, allowed.allow_components,
             rate=rate, name=f"{direction}.rate")
        for message, rate in rates
        if not allowed.allow_messages or message in allowed.allow_messages
    )  # fmt: skip
    commands = _commands(packet_filter, direction)
    restricted = allowed.allow_messages or allowed.allow_systems or allowed.allow_components
    if not restricted:
        return (*denials, *commands, *limited), "pass"
    passing = Rule(
        "pass",
        allowed.allow_messages,
        allowed.allow_systems,
        allowed.allow_components,
        name=f"{direction}.allow",
    )
    return (*denials, *commands, *limited, passing), "drop"


def _denials(packet_filter: PacketFilter, direction: str) -> Iterator[Rule]:
    if packet_filter.deny_messages:
        yield Rule("drop", messages=packet_filter.deny_messages, name=f"{direction}.deny_messages")
    if packet_filter.deny_systems:
        yield Rule("drop", systems=packet_filter.deny_systems, name=f"{direction}.deny_systems")
    if packet_filter.deny_components:
        yield Rule("drop", components=packet_filter.deny_components, name=f"{direction}.deny_components")
    if packet_filter.deny_commands:
        yield Rule("drop", commands=packet_filter.deny_commands, name=f"{direction}.deny_commands")


def _commands(packet_filter: PacketFilter, direction: str) -> Iterator[Rule]:
    """Yield the rules that drop all commands but the allowed ones; other messages match none of them."""
    if not packet_filter.allow_commands:
        return
    messages = packet_filter.allow_messages & COMMAND_MESSAGES or COMMAND_MESSAGES
    if not packet_filter.allow_messages or packet_filter.allow_messages & COMMAND_MESSAGES:
        yield Rule(
            "pass", messages, packet_filter.allow_systems, packet_filter.allow_components,
            commands=packet_filter.allow_commands, name=f"{direction}.allow_commands",
        )  # fmt: skip
    yield Rule("drop", messages=COMMAND_MESSAGES, name=f"{direction}.allow_commands")
