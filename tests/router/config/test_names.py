from __future__ import annotations

import pytest

from mavstack.router.config.names import Names, system


@pytest.fixture(scope="module")
def names():
    return Names("all")


def test_names_and_numbers(names):
    assert names.message("HEARTBEAT") == names.message(0) == 0
    assert names.message("attitude") == 30
    assert names.command("COMPONENT_ARM_DISARM") == names.command("MAV_CMD_COMPONENT_ARM_DISARM") == 400
    assert names.component("AUTOPILOT1") == names.component("MAV_COMP_ID_AUTOPILOT1") == 1
    assert names.message_name(0) == "HEARTBEAT"
    assert names.message_name(16_000_000) == 16_000_000
    assert system(255) == 255


def test_misspelled_names_get_a_suggestion(names):
    with pytest.raises(ValueError, match="did you mean HEARTBEAT"):
        names.message("HEARTBAET")
    with pytest.raises(ValueError, match="did you mean COMPONENT_ARM_DISARM"):
        names.command("COMPONENT_ARM_DISRAM")


@pytest.mark.parametrize("value", [-1, 1 << 24, True, None, 1.5, "no such thing at all"])
def test_others_are_refused(names, value):
    with pytest.raises(ValueError, match="message"):
        names.message(value)


@pytest.mark.parametrize("value", [0, 256, "1", True])
def test_systems_are_numbers(value):
    with pytest.raises(ValueError, match="1 to 255"):
        system(value)


def test_a_dialect_without_commands_has_no_rules_for_commands():
    with pytest.raises(ValueError, match="set another dialect"):
        Names("minimal").command(400)
