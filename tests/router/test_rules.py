"""Rules that are wrong are refused where they are made."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.router import Rule, RuleSet


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"action": "deny"}, "action must be one of pass, drop, inspect, got 'deny'"),
        ({"messages": frozenset({1 << 24})}, "messages must be 0 to 16777215, got 16777216"),
        ({"systems": frozenset({256})}, "systems must be 0 to 255, got 256"),
        ({"components": frozenset({-1})}, "components must be 0 to 255, got -1"),
        ({"target_systems": frozenset({256})}, "target_systems must be 0 to 255, got 256"),
        ({"commands": frozenset({65536})}, "commands must be 0 to 65535, got 65536"),
        ({"rate": 0.0}, "rate must be positive and finite, or None, got 0.0"),
        ({"rate": float("nan")}, "rate must be positive and finite, or None, got nan"),
    ],
)
def test_a_rule_out_of_range_is_refused(values, reason):
    with pytest.raises(InvalidArgumentError) as error:
        Rule(**({"action": "drop"} | values))
    assert str(error.value) == reason


def test_a_rule_set_checks_its_defaults_and_its_byte_rate():
    with pytest.raises(InvalidArgumentError, match="default_incoming must be one of"):
        RuleSet(default_incoming="deny")
    with pytest.raises(InvalidArgumentError, match="bytes_per_second must be positive"):
        RuleSet(bytes_per_second=-1.0)
