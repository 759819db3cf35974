"""The channels that a bridge sends, and who is in control."""

from __future__ import annotations

from mavstack.bridges.msp.rc_channels import CHANNELS, CONTROL_TIMEOUT, RcChannels
from mavstack.services import Address

GROUND, OTHER = Address(255, 190), Address(254, 190)


def test_the_channel_map() -> None:
    channels = RcChannels()
    channels.set_sticks(roll=1000, pitch=-1000, yaw=0, throttle=250)
    assert channels.pulses()[:5] == [2000, 1000, 1250, 1500, 1000]  # AETR
    channels.channel_map = (1, 2, 3, 0)  # TAER
    assert channels.pulses()[:4] == [1250, 2000, 1000, 1500]
    assert channels.to_receiver_order([11, 12, 13, 14, 15]) == [14, 11, 12, 13, 15]
    assert len(channels.pulses()) == CHANNELS


def test_sticks_are_clamped_and_kept() -> None:
    channels = RcChannels()
    channels.set_sticks(roll=5000, pitch=None, yaw=None, throttle=-1000)
    assert channels.pulses()[:4] == [2000, 1500, 1000, 1500]
    channels.set_sticks(roll=None, pitch=None, yaw=None, throttle=5000)
    assert channels.pulses()[:4] == [2000, 1500, 2000, 1500]
    assert not channels.throttle_is_low()


def test_overrides_and_switches() -> None:
    channels = RcChannels()
    channels.set_aux(0, 1800)
    channels.set_aux(99, 1800)
    channels.set_overrides({6: 1700, 18: 1700})
    assert channels.pulses()[4:7] == [1800, 1700, 1000]
    channels.set_overrides({})
    assert (channels.pulses()[5], channels.aux(0), channels.aux(99)) == (1000, 1800, 1000)


def test_one_is_in_control_until_it_is_silent() -> None:
    channels = RcChannels()
    channels.take_control(GROUND, 10.0)
    channels.set_aux(0, 1800)
    assert channels.may_control(GROUND)
    assert not channels.may_control(OTHER)
    channels.sign_of_life(OTHER, 12.0)
    channels.sign_of_life(GROUND, 12.0)
    assert not channels.check_pilot(12.0 + CONTROL_TIMEOUT - 0.1)
    assert channels.check_pilot(12.0 + CONTROL_TIMEOUT)
    assert channels.pilot is None
    assert channels.aux(0) == 1000  # a later pilot does not find the vehicle armed
    assert channels.may_control(OTHER)
    assert not channels.check_pilot(100.0)


def test_a_channel_map_that_moves_aux_channels() -> None:
    channels = RcChannels()
    channels.channel_map = (4, 5, 7, 6, 0, 1, 2, 3)
    channels.set_aux(0, 1800)
    assert channels.pulses()[:9] == [1800, 1000, 1000, 1000, 1500, 1500, 1000, 1500, 1000]
    assert channels.to_receiver_order(range(9)) == [4, 5, 6, 7, 0, 1, 3, 2, 8]
