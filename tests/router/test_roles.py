from __future__ import annotations

import pytest

from mavstack.dialects import Dialect
from mavstack.router.roles import rules_of
from mavstack.router.rules import RuleSet
from mavstack.security.roles import COMMAND_MESSAGES, Role, allows

COMMON = Dialect.load("common")
CARRIERS = [COMMON[name].definition.id for name in COMMAND_MESSAGES]
COMMANDS = [int(member) for member in COMMON.enums["MAV_CMD"]]


def decide(rules: RuleSet, message: int, command: int | None = None) -> str:
    """Apply the rules as the engine does."""
    for rule in rules.incoming:
        if message in rule.messages and (not rule.commands or command in rule.commands):
            return rule.action
    return rules.default_incoming


@pytest.mark.parametrize("role", [Role.OBSERVE, Role.OPERATE])
def test_the_rules_and_the_role_allow_the_same_packets(role):
    rules = rules_of(role)
    for number in (message.definition.id for message in COMMON):
        if number not in CARRIERS:
            assert (decide(rules, number) == "pass") is allows(role, number)
    for command in [*COMMANDS, 60_000]:
        for carrier in CARRIERS[:2]:
            assert (decide(rules, carrier, command) == "pass") is allows(role, carrier, command)
    assert decide(rules, 16_000_000) == "drop"
    assert rules.outgoing == ()


def test_mission_items_are_for_the_program_to_decide():
    assert decide(rules_of(Role.OPERATE), CARRIERS[2], 16) == "inspect"
    assert decide(rules_of(Role.OPERATE, mission_items="pass"), CARRIERS[3], 16) == "pass"
    assert decide(rules_of(Role.OBSERVE), CARRIERS[2], 16) == "drop"


def test_an_administrator_has_no_rules():
    assert rules_of(Role.ADMINISTER) == RuleSet()
