from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.manual_control import RELEASE, ChannelOverride, ManualInput
from tests.services.network import VEHICLE

axis = st.none() | st.integers(-1000, 1000)


@given(axis, axis, axis, axis, st.integers(0, 2**32 - 1), axis, axis, st.tuples(*[axis] * 6))
def test_an_input_comes_back_as_it_was(x, y, z, r, buttons, s, t, aux):
    sticks = ManualInput(x, y, z, r, buttons, s, t, aux)
    assert ManualInput.read(sticks.to_message(1)) == sticks


def test_an_absent_axis_is_int16_max_and_extensions_are_enabled_by_bits():
    message = ManualInput(x=5, t=7, aux=(None, None, None, None, None, -9)).to_message(3)
    assert (message.target, message.x, message.y, message.z, message.r) == (3, 5, 32767, 32767, 32767)
    assert (message.enabled_extensions, message.s, message.t, message.aux6) == (0b10000010, 0, 7, -9)


def test_without_extensions_as_in_mavlink_1_there_are_four_axes_and_16_buttons():
    message = common.ManualControl(x=1, y=2, z=3, r=4, buttons=0x8001)
    assert ManualInput.read(message) == ManualInput(1, 2, 3, 4, 0x8001)


def test_an_axis_beyond_its_range_is_at_its_end():
    assert ManualInput.read(common.ManualControl(x=1001, y=-32768, z=32766, r=32767)) == ManualInput(
        1000, -1000, 1000, None
    )


@pytest.mark.parametrize("sticks", [ManualInput(x=1001), ManualInput(buttons=1 << 32), ManualInput(s=-1001)])
def test_impossible_inputs_are_our_own_misuse(sticks):
    with pytest.raises(InvalidArgumentError):
        sticks.to_message(1)


def test_release_and_ignore_differ_between_the_first_eight_channels_and_the_rest():
    message = ChannelOverride({1: 1500, 2: RELEASE, 9: 1100, 10: RELEASE}).to_message(VEHICLE)
    assert [message.chan1_raw, message.chan2_raw, message.chan3_raw] == [1500, 0, 65535]
    assert [message.chan9_raw, message.chan10_raw, message.chan11_raw] == [1100, 65534, 65535]


def test_zero_leaves_channels_from_nine_on_alone():
    message = common.RcChannelsOverride(chan1_raw=1500, chan8_raw=65535)
    channels = ChannelOverride.read(message).channels
    assert channels == {1: 1500, **dict.fromkeys(range(2, 8), RELEASE)}
    message = common.RcChannelsOverride(
        **{f"chan{n}_raw": 65535 for n in range(1, 9)}, chan9_raw=65534, chan18_raw=1900
    )
    assert ChannelOverride.read(message).channels == {9: RELEASE, 18: 1900}


@given(st.dictionaries(st.integers(1, 18), st.integers(0, 2200)))
def test_an_override_comes_back_as_it_was(channels):
    assert ChannelOverride.read(ChannelOverride(channels).to_message(VEHICLE)).channels == channels


@pytest.mark.parametrize("channels", [{0: 1500}, {19: 1500}, {1: -1}, {9: 65534}, {1: 65535}])
def test_impossible_overrides_are_our_own_misuse(channels):
    with pytest.raises(InvalidArgumentError):
        ChannelOverride(channels).to_message(VEHICLE)
