"""Boxes as flight modes."""

from __future__ import annotations

from mavstack.bridges.msp.boxes import ACRO, FAILSAFE, Boxes
from mavstack.dialects import common

BETAFLIGHT = Boxes(is_inav=False, ids=(0, 1, 2, 46, 27, 13), names=("ARM", "ANGLE", "HORIZON", "GPS RESCUE"))


def test_the_active_boxes_are_those_at_the_positions() -> None:
    assert BETAFLIGHT.active((0, 3, 99)) == {0, 46}


def test_the_mode_with_the_highest_precedence() -> None:
    assert BETAFLIGHT.custom_mode(frozenset({0, 13})) == ACRO
    assert BETAFLIGHT.custom_mode(frozenset({0, 1})) == 1
    assert BETAFLIGHT.custom_mode(frozenset({0, 1, 46})) == 46
    assert BETAFLIGHT.custom_mode(frozenset({0, 46, FAILSAFE})) == FAILSAFE


def test_names_standard_modes_and_the_failsafe_that_users_cannot_select() -> None:
    modes = {mode.custom_mode: mode for mode in BETAFLIGHT.modes()}
    assert [mode.name for mode in modes.values()] == ["ACRO", "ANGLE", "HORIZON", "BOX 27", "GPS RESCUE"]
    assert modes[46].standard_mode == common.MavStandardMode.SAFE_RECOVERY
    assert not modes[FAILSAFE].selectable
    assert BETAFLIGHT.flight_modes() == {1, 2, 46}
    assert 13 in BETAFLIGHT
    assert 3 not in BETAFLIGHT


def test_one_number_means_another_mode_with_inav() -> None:
    inav = Boxes(is_inav=True, ids=(0, 28, 46), names=("ARM", "NAV WP", "MC BRAKING"))
    assert inav.custom_mode(frozenset({46})) == ACRO
    assert inav.modes()[1].standard_mode == common.MavStandardMode.MISSION


def test_names_that_texts_of_mavlink_do_not_hold() -> None:
    boxes = Boxes(is_inav=False, ids=(1, 2), names=("ANGLÉ\x1b[31m", "HORIZON"))
    assert (boxes.name(1), boxes.name(2)) == ("ANGL??[31m", "HORIZON")
