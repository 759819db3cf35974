"""Pulses of AUX channels that enter a flight mode."""

from __future__ import annotations

from mavstack.bridges.msp.mode_switches import ModeSwitches, Switch

ANGLE, HORIZON, RTH, POSHOLD = 1, 2, 10, 11
MODES = {ANGLE, HORIZON, RTH, POSHOLD}


def test_one_channel_with_three_positions() -> None:
    switches = ModeSwitches([Switch(ANGLE, 1, 1300, 1700), Switch(RTH, 1, 1700, 2100)])
    assert switches.pulses_for(ANGLE, MODES) == {1: 1500}
    assert switches.pulses_for(RTH, MODES) == {1: 1850}
    assert switches.pulses_for(0, MODES) == {1: 1000}
    assert switches.pulses_for(HORIZON, MODES) is None


def test_other_channels_are_switched_off() -> None:
    switches = ModeSwitches([Switch(ANGLE, 1, 900, 1300), Switch(RTH, 2, 1700, 2100)])
    assert switches.pulses_for(RTH, MODES) == {1: 1300, 2: 1850}
    assert switches.pulses_for(ANGLE, MODES) == {1: 1150, 2: 1000}


def test_overlapping_ranges_choose_the_fewest_other_modes() -> None:
    switches = ModeSwitches([Switch(POSHOLD, 0, 1300, 2100), Switch(RTH, 0, 1600, 2100)])
    pulse = (switches.pulses_for(POSHOLD, MODES) or {})[0]
    assert 1300 <= pulse < 1600


def test_other_boxes_and_empty_ranges_do_not_count() -> None:
    switches = ModeSwitches([Switch(13, 3, 1700, 2100), Switch(ANGLE, 1, 900, 900)])
    assert switches.pulses_for(0, MODES) == {}
    assert switches.find(ANGLE) is None
    assert switches.find(13) == Switch(13, 3, 1700, 2100)


def test_the_pulse_that_switches_off() -> None:
    assert ModeSwitches([Switch(0, 0, 1700, 2100)]).off_pulses(0) == {0: 1000}
    assert ModeSwitches([Switch(0, 0, 900, 1300)]).off_pulses(0) == {0: 1300}
    assert ModeSwitches([Switch(0, 0, 900, 2100)]).off_pulses(0) is None
    assert ModeSwitches().off_pulses(0) == {}


def test_all_channels_of_a_switch_are_switched_off() -> None:
    switches = ModeSwitches([Switch(0, 0, 1700, 2100), Switch(0, 3, 900, 1200), Switch(1, 2, 900, 1200)])
    assert switches.channels(0) == {0, 3}
    assert switches.off_pulses(0) == {0: 1000, 3: 1200}
    assert ModeSwitches([Switch(0, 0, 1700, 2100), Switch(0, 3, 900, 2100)]).off_pulses(0) is None
