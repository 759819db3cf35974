from __future__ import annotations

from mavstack.msp import FirmwareInfo
from mavstack.msp.commands import MspCommand, command_name


def test_names_of_commands() -> None:
    inav = FirmwareInfo("INAV")
    assert command_name(MspCommand.MSP_API_VERSION) == "MSP_API_VERSION"
    assert (command_name(247), command_name(247, inav)) == ("MSP_RTC", "MSP_SET_RTC")
    assert (command_name(101, inav), command_name(0x2000)) == ("MSP_STATUS", "MSP2_INAV_STATUS")
    assert command_name(9999) == "command 9999"
