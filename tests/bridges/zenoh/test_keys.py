from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.zenoh.keys import (
    TABLE,
    VehicleKeys,
    checked_name,
    checked_prefix,
    command_of,
    gateway_key,
    parse_alive,
    vehicle_of,
)
from mavstack.errors import InvalidArgumentError

NAMES = st.from_regex(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,20}", fullmatch=True)


@given(prefix=st.lists(NAMES, min_size=1, max_size=3).map("/".join), vehicle=NAMES, gateway=NAMES)
def test_tokens_and_keys_are_read_as_they_were_made(prefix: str, vehicle: str, gateway: str) -> None:
    keys = VehicleKeys(checked_prefix(f"/{prefix}/"), vehicle)
    assert parse_alive(prefix, keys.alive(gateway)) == (vehicle, gateway)
    assert parse_alive(prefix, gateway_key(prefix, gateway)) is None
    for key in (keys.frames_out, keys.state("gps"), keys.message(1, "ATTITUDE")):
        assert vehicle_of(prefix, key) == vehicle
        assert parse_alive(prefix, key) is None
    assert command_of(keys.command("action/takeoff")) == "action/takeoff"


@given(st.text())
def test_any_key_is_read(key: str) -> None:
    found = parse_alive("mavstack", key)
    assert found is None or key == VehicleKeys("mavstack", found[0]).alive(found[1])
    assert "*" not in command_of(key)


@pytest.mark.parametrize("name", ["", "a/b", "*", "@gateway", "$*", "a b", "a?b", "a#", "x" * 65, "\n", "é"])
def test_names_that_are_not_a_part_of_a_key(name: str) -> None:
    with pytest.raises(InvalidArgumentError, match=r"must have letters, digits"):
        checked_name(name, "a name")


def test_an_expression_names_no_command() -> None:
    assert command_of("mavstack/**") == ""
    assert command_of("mavstack/alpha/command/*") == ""
    assert command_of("mavstack/alpha/command/action/$*") == ""
    assert command_of("mavstack/*/command/hold") == "hold"


def test_the_table_has_the_keys() -> None:
    keys = VehicleKeys("mavstack", "alpha")
    ends = {end for _, end, _ in TABLE}
    found = {keys.frames_out, keys.frames_in, keys.state("<group>"), keys.command("<name>")}
    found |= {keys.message(0, "<MESSAGE>").replace("/0/", "/<component>/"), keys.alive("<gateway>")}
    assert {f"mavstack/alpha/{end}" for end in ends} == found
