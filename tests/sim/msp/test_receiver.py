from __future__ import annotations

import pytest

from mavstack.sim.msp.receiver import LOST_THROTTLE, Receiver, Sticks, letters_of, map_of


def test_channels_come_in_the_order_of_the_map_and_are_kept_as_roll_pitch_yaw_throttle():
    receiver = Receiver()
    receiver.receive([1100, 1200, 1300, 1400, 1500, 1600], 0.0)
    assert receiver.channels[:6] == [1100, 1200, 1400, 1300, 1500, 1600]
    receiver.channel_map = map_of("TAER1234")
    receiver.receive([1100, 1200, 1300, 1400, 1500, 1600], 0.0)
    assert receiver.channels[:6] == [1200, 1300, 1400, 1100, 1500, 1600]


def test_without_frames_the_sticks_go_to_their_values_without_signal_and_switches_stay():
    receiver = Receiver()
    receiver.receive([1900, 1900, 1900, 1900, 1800], 10.0)
    receiver.step(10.2)
    assert receiver.has_signal(10.2)
    assert receiver.channels[:5] == [1900, 1900, 1900, 1900, 1800]
    receiver.step(10.4)
    assert not receiver.has_signal(10.4)
    assert receiver.channels[:5] == [1500, 1500, 1500, LOST_THROTTLE, 1800]


def test_invalid_pulses_and_a_transmitter_that_is_off_change_nothing():
    receiver = Receiver()
    receiver.receive([1500, 1500, 1000, 1500, 1800], 0.0)
    receiver.receive([0, 65535, 1000, 1500, 1800], 0.1)
    assert receiver.channels[:2] == [1500, 1500]
    receiver.is_on = False
    receiver.receive([1900] * 5, 0.2)
    assert receiver.channels[0] == 1500
    assert not receiver.has_signal(0.2)


def test_sticks_have_dead_bands():
    receiver = Receiver()
    receiver.receive([2000, 1490, 1500, 1000], 0.0)
    assert receiver.sticks(1050, 10, 0) == Sticks(1.0, 0.0, -1.0, pytest.approx(450 / 950))


@pytest.mark.parametrize("letters", ["AETR1234", "TAER1234", "AETR", "RETA"])
def test_maps_and_letters(letters):
    assert letters_of(map_of(letters)) == letters


@pytest.mark.parametrize("letters", ["AET", "AAETR", "AETX"])
def test_letters_that_are_no_map(letters):
    with pytest.raises(ValueError, match=letters):
        map_of(letters)


def test_the_letters_of_positions_that_are_no_map():
    assert letters_of((0, 1, 200, 2)) == "AET"
