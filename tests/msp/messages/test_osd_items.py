from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.msp.messages.osd_items import OSD_ITEMS, OsdPosition


def test_items_have_the_numbers_of_betaflight() -> None:
    assert [OSD_ITEMS.index(name) for name in ("RSSI_VALUE", "WARNINGS", "LINK_QUALITY")] == [0, 21, 46]


def test_position_of_an_item() -> None:
    assert OsdPosition.from_bits(2048 + (13 << 5) + 8) == OsdPosition(8, 13, (1,))
    assert OsdPosition(40, 3, (1, 3), kind=1).to_bits() == 0x4000 + 0x2800 + 0x400 + (3 << 5) + 8


@pytest.mark.properties
@given(bits=st.integers(0, 65535))
def test_every_number_is_a_position(bits: int) -> None:
    assert OsdPosition.from_bits(bits).to_bits() == bits


@pytest.mark.parametrize("wrong", [(64, 0), (0, 32), (-1, 0), (0, 0, (4,)), (0, 0, (), 4)])
def test_positions_outside_the_display_are_refused(wrong: tuple[int, ...]) -> None:
    with pytest.raises(InvalidArgumentError):
        OsdPosition(*wrong)
