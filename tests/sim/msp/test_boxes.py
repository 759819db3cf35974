from __future__ import annotations

from mavstack.sim.msp.boxes import BETAFLIGHT_BOXES, INAV_BOXES, ModeRange
from mavstack.sim.msp.receiver import CHANNELS

CHANNELS_LOW = [1500, 1500, 1500, 1000] + [1000] * (CHANNELS - 4)


def channels(**aux: int) -> list[int]:
    values = list(CHANNELS_LOW)
    for name, value in aux.items():
        values[3 + int(name.removeprefix("aux"))] = value
    return values


def test_a_range_switches_its_box_on():
    ranges = [ModeRange(0, 0, 32, 48), ModeRange(1, 1, 12, 48)]
    assert BETAFLIGHT_BOXES.switched_on(ranges, CHANNELS_LOW) == frozenset()
    assert BETAFLIGHT_BOXES.switched_on(ranges, channels(aux1=1700)) == {"ARM"}
    assert BETAFLIGHT_BOXES.switched_on(ranges, channels(aux1=1699, aux2=1200)) == {"ANGLE"}


def test_ranges_with_and_must_all_hold():
    ranges = [ModeRange(13, 0, 32, 48, 1), ModeRange(13, 1, 32, 48, 1)]
    assert BETAFLIGHT_BOXES.switched_on(ranges, channels(aux1=1800)) == frozenset()
    assert BETAFLIGHT_BOXES.switched_on(ranges, channels(aux1=1800, aux2=1800)) == {"BEEPER"}


def test_flags_are_bits_in_the_order_of_the_boxes():
    assert BETAFLIGHT_BOXES.flags(["ARM"]) == 1
    position = [box.name for box in INAV_BOXES.boxes].index("NAV WP")
    assert INAV_BOXES.flags(["ARM", "NAV WP"]) == 1 | 1 << position
