"""Reasons not to arm as status texts."""

from __future__ import annotations

from mavstack.bridges.msp.arming_reasons import _WORDS, reason_texts
from mavstack.msp.messages.arming import FIRST_INAV_REASON, ArmingDisableFlag, InavArmingFlag


def test_words_and_constants() -> None:
    assert reason_texts(("ANGLE", "NEW_ONE")) == ("PreArm: not level (ANGLE)", "PreArm: NEW_ONE")


def test_the_arm_switch_is_a_reason_alone_only() -> None:
    assert reason_texts(("RX_FAILSAFE", "ARM_SWITCH")) == ("PreArm: no RC signal (RX_FAILSAFE)",)
    assert reason_texts(("ARM_SWITCH",)) == ("PreArm: arm switch is on (ARM_SWITCH)",)


def test_every_reason_has_words() -> None:
    names = {flag.name for flag in ArmingDisableFlag}
    names |= {flag.name for flag in InavArmingFlag if flag >= FIRST_INAV_REASON}
    assert names - _WORDS.keys() == set()
