"""The messages about one mode."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.modes import AvailableMode

PROPERTY, STANDARD = common.MavModeProperty, common.MavStandardMode


@pytest.mark.parametrize(
    ("properties", "selectable", "advanced"),
    [
        (0, True, False),
        (PROPERTY.ADVANCED, True, True),
        (PROPERTY.NOT_USER_SELECTABLE, False, False),
        (PROPERTY.ADVANCED | PROPERTY.NOT_USER_SELECTABLE | PROPERTY.AUTO_MODE, False, True),
        (PROPERTY.AUTO_MODE | 1 << 31, True, False),
    ],
)
def test_who_may_be_offered_it(properties: int, selectable: bool, advanced: bool) -> None:
    mode = AvailableMode(4, "Hold", properties=int(properties))
    assert (mode.selectable, mode.advanced) == (selectable, advanced)
    received = AvailableMode.read(mode.to_message(1, 1))
    assert (received.selectable, received.advanced) == (selectable, advanced)


def test_a_mode_is_read_as_it_was_reported() -> None:
    mode = AvailableMode(0x05040000, "Rückkehr", STANDARD.SAFE_RECOVERY, PROPERTY.AUTO_MODE)
    message = mode.to_message(2, 3)
    assert (message.mode_index, message.number_modes) == (2, 3)
    assert AvailableMode.read(message) == mode


def test_a_long_name_is_cut_between_characters() -> None:
    name = "x" * 34 + "ü"
    assert AvailableMode.read(AvailableMode(1, name).to_message(1, 1)).name == "x" * 34
