from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.router.config import EndpointConfig, PacketFilter
from mavstack.router.filters import COMMAND_MESSAGES, rules_of
from mavstack.router.rules import Rule

MESSAGES = st.frozensets(st.sampled_from([0, 30, 33, 75, 76]), max_size=3)
IDS = st.frozensets(st.sampled_from([1, 2, 255]), max_size=2)
COMMANDS = st.frozensets(st.sampled_from([176, 400]), max_size=1)
FILTERS = st.builds(
    PacketFilter,
    allow_messages=MESSAGES,
    deny_messages=MESSAGES,
    allow_systems=IDS,
    deny_systems=IDS,
    allow_components=IDS,
    deny_components=IDS,
    allow_commands=COMMANDS,
    deny_commands=COMMANDS,
)
PACKETS = st.tuples(
    st.sampled_from([0, 30, 33, 75, 76]), st.sampled_from([1, 2, 255]), st.sampled_from([1, 2, 255]),
    st.sampled_from([176, 400, 511]),
)  # fmt: skip


def matches(rule, packet):
    message, system, component, command = packet
    return (
        (not rule.messages or message in rule.messages)
        and (not rule.systems or system in rule.systems)
        and (not rule.components or component in rule.components)
        and (not rule.commands or (message in COMMAND_MESSAGES and command in rule.commands))
    )


def passes(rules, default, packet):
    """True if the first rule that matches passes a packet, as the engine decides."""
    return next((rule.action for rule in rules if matches(rule, packet)), default) == "pass"


def allows(packet_filter, packet):
    """True if all conditions of a filter hold, as the documentation says."""
    message, system, component, command = packet
    of = packet_filter
    is_command = message in COMMAND_MESSAGES
    return (
        message not in of.deny_messages
        and system not in of.deny_systems
        and component not in of.deny_components
        and not (is_command and command in of.deny_commands)
        and (not of.allow_messages or message in of.allow_messages)
        and (not of.allow_systems or system in of.allow_systems)
        and (not of.allow_components or component in of.allow_components)
        and (not is_command or not of.allow_commands or command in of.allow_commands)
    )


@pytest.mark.properties
@settings(max_examples=60, deadline=None)
@given(FILTERS, PACKETS, st.booleans())
def test_rules_pass_what_the_filter_allows(packet_filter, packet, with_rates):
    rates = ((30, 4.0), (76, 1.0)) if with_rates else ()
    found = rules_of(EndpointConfig("a", incoming=packet_filter, outgoing=packet_filter, rates=rates))
    assert passes(found.incoming, found.default_incoming, packet) == allows(packet_filter, packet)
    assert passes(found.outgoing, found.default_outgoing, packet) == allows(packet_filter, packet)


def test_rates_limit_packets_to_the_endpoint():
    found = rules_of(EndpointConfig("a", rate=1000.0, rates=((30, 4.0),)))
    assert found.outgoing == (Rule("pass", frozenset({30}), rate=4.0, name="out.rate"),)
    assert (found.incoming, found.default_outgoing, found.bytes_per_second) == ((), "pass", 1000.0)


def test_a_rate_passes_no_message_that_is_not_allowed():
    endpoint = EndpointConfig("a", rates=((30, 4.0),), outgoing=PacketFilter(allow_messages=frozenset({0})))
    assert not any(rule.rate for rule in rules_of(endpoint).outgoing)


def test_rules_of_a_firewall_come_first():
    first = Rule("drop", frozenset({1}), name="firewall")
    endpoint = EndpointConfig("a", incoming=PacketFilter(deny_messages=frozenset({2})))
    found = rules_of(endpoint, incoming=(first,), outgoing=(first,))
    assert [rule.name for rule in found.incoming] == ["firewall", "in.deny_messages"]
    assert found.outgoing == (first,)
    assert rules_of(replace(endpoint, incoming=PacketFilter())).incoming == ()
