from __future__ import annotations

from mavstack.msp import FirmwareInfo
from mavstack.msp.messages.arming import (
    ArmingDisableFlag,
    InavArmingFlag,
    betaflight_arming_reasons,
    inav_arming_reasons,
)
from mavstack.msp.messages.status import InavStatus, Status, StatusEx

HEAD = bytes.fromhex("7d00 0000 2100 03000000 00 0c00")


def test_the_last_flag_of_every_betaflight_is_its_arm_switch() -> None:
    throttle = int(ArmingDisableFlag.THROTTLE)
    assert betaflight_arming_reasons(throttle | 1 << 25, 26) == ("THROTTLE", "ARM_SWITCH")
    assert betaflight_arming_reasons(1 << 25 | 1 << 29, 30) == ("CRASHFLIP", "ARM_SWITCH")
    assert betaflight_arming_reasons(1 << 30, None) == ("FLAG_30",)


def test_state_of_inav_is_no_reason() -> None:
    flags = (
        InavArmingFlag.ARMED
        | InavArmingFlag.WAS_EVER_ARMED
        | InavArmingFlag.NOT_LEVEL
        | InavArmingFlag.RC_LINK
    )
    assert inav_arming_reasons(flags) == ("NOT_LEVEL", "RC_LINK")


def test_status_of_betaflight() -> None:
    payload = HEAD + bytes.fromhex("03 01 02 0100 1a 80000002 00 2800 04")
    status = StatusEx.decode(payload)
    assert (status.load, status.rate_profile, status.core_temperature) == (12, 1, 40)
    assert status.active_modes == (0, 1, 32)
    assert status.arming_disable_reasons == ("THROTTLE", "ARM_SWITCH")
    assert status.encode() == payload
    assert Status.decode(HEAD[:11]).arming_disable_reasons is None


def test_status_of_inav() -> None:
    inav = FirmwareInfo("INAV")
    short = StatusEx.decode(HEAD + bytes.fromhex("0041 00"), inav)
    assert short.arming_disable_reasons == ("NOT_LEVEL", "ARM_SWITCH")
    payload = bytes.fromhex("e803 0000 0180 0a00 21 04090000 01000000 02000000 01")
    status = InavStatus.decode(payload, inav)
    assert (status.pid_profile, status.battery_profile, status.mixer_profile) == (1, 2, 1)
    assert (status.is_armed, status.active_modes) == (True, (0, 33))
    assert status.arming_disable_reasons == ("NOT_LEVEL", "NAVIGATION_UNSAFE")
    assert status.encode(inav) == payload
