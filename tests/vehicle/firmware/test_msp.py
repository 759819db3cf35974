"""Betaflight and iNav are recognised by AUTOPILOT_VERSION; their calls are tested with their bridge."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.version import AutopilotVersion
from mavstack.vehicle.firmware import ArduPilot, Betaflight, Firmware, Inav, MspFirmware, firmware_class

GENERIC, ARDUPILOT = common.MavAutopilot.GENERIC, common.MavAutopilot.ARDUPILOTMEGA


@pytest.mark.parametrize(
    ("autopilot", "identifier", "found"),
    [
        (GENERIC, "BTFL", Betaflight),
        (GENERIC, "INAV", Inav),
        (GENERIC, "", Firmware),
        (GENERIC, "CLFL", Firmware),
        (ARDUPILOT, "BTFL", ArduPilot),
        (None, "BTFL", Firmware),
    ],
)
def test_the_class_of_a_firmware(autopilot, identifier, found):
    assert firmware_class(autopilot, identifier) is found


def test_firmwares_have_names():
    assert [each.NAME for each in (Firmware, ArduPilot, Betaflight, Inav)] == [
        "",
        "ArduPilot",
        "Betaflight",
        "iNav",
    ]


def test_simulated_boards_have_no_bootloader():
    assert MspFirmware.has_bootloader(AutopilotVersion(operating_system_custom=b"S405"))
    assert not MspFirmware.has_bootloader(AutopilotVersion(operating_system_custom=b"SITL\0\0\0\0"))
    assert not Firmware.has_bootloader(AutopilotVersion(operating_system_custom=b"S405"))


def test_features_that_are_lacking_have_words():
    for firmware in (Betaflight, Inav):
        words = firmware.LACKING.values()
        assert len(set(words)) == len(words)
    assert set(Betaflight.LACKING) - set(Inav.LACKING) == {"mission"}
