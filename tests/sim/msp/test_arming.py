from __future__ import annotations

import pytest

from mavstack.sim.msp.arming import BETAFLIGHT_REASONS, INAV_REASONS, Arming


@pytest.fixture
def changes():
    return []


@pytest.fixture
def arming(changes):
    return Arming(BETAFLIGHT_REASONS, lambda armed, reason: changes.append((armed, reason)))


def test_the_bits_are_those_of_the_firmwares():
    assert (BETAFLIGHT_REASONS["RX_FAILSAFE"], BETAFLIGHT_REASONS["ARM_SWITCH"]) == (2, 25)
    assert (INAV_REASONS["RC_LINK"], INAV_REASONS["ARM_SWITCH"]) == (18, 14)


def test_the_switch_arms_and_disarms(arming, changes):
    arming.step([], switch_on=True)
    assert arming.armed
    arming.step([], switch_on=False)
    assert changes == [(True, "switch"), (False, "switch")]


def test_a_reason_latches_the_switch_until_it_goes_off(arming, changes):
    arming.step(["THROTTLE"], switch_on=True)
    assert arming.reasons == ("THROTTLE", "ARM_SWITCH")
    assert arming.flags == 1 << 7 | 1 << 25
    arming.step([], switch_on=True)
    assert arming.reasons == ("ARM_SWITCH",)
    arming.step([], switch_on=False)
    arming.step([], switch_on=True)
    assert changes == [(True, "switch")]


def test_after_a_disarming_by_the_firmware_the_switch_must_go_off_first(arming):
    arming.step([], switch_on=True)
    arming.disarm("failsafe")
    arming.step([], switch_on=True)
    assert not arming.armed
    assert arming.reasons == ("ARM_SWITCH",)
