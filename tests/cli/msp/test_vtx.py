"""`mav msp vtx` against a small flight controller, in virtual time."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from mavstack.cli.main import main
from mavstack.msp import FirmwareInfo
from mavstack.msp.messages.vtx import SetVtxConfig, VtxConfig, VtxTableBand, VtxTablePowerLevel, VtxType
from tests.bridges.msp.controllers import IDENTITY

DEVICE = "/dev/ttyACM9"
INFO = FirmwareInfo("BTFL", (4, 5, 1), (1, 46))
CONFIG, SET_CONFIG, BAND, POWER = 88, 89, 137, 138


@pytest.fixture
def configs(firmware):
    """The settings of a transmitter that keeps those which it is sent."""
    configs = [VtxConfig(VtxType.TRAMP, 5, 3, 1, False, 5732, True, 0, 0, True, 5, 8, 3)]

    def keep(payload):
        new = SetVtxConfig.decode(payload, INFO)
        configs.append(
            replace(configs[-1], band=new.band, channel=new.channel, power=new.power, pit_mode=new.pit_mode)
        )
        return b""

    firmware.replies = {
        **IDENTITY,
        CONFIG: lambda _: configs[-1].encode(INFO),
        SET_CONFIG: keep,
        BAND: VtxTableBand(5, "RACEBAND", "R", True, (5658,)).encode(INFO),
        POWER: VtxTablePowerLevel(1, 25, "25 ").encode(INFO),
    }
    return configs


def test_the_transmitter(configs, capsys):
    assert main(["msp", "vtx", DEVICE, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["type"], document["band"], document["band_name"]) == ("TRAMP", 5, "RACEBAND")
    assert (document["frequency_mhz"], document["pit_mode"], document["power_label"]) == (5732, False, "25")
    assert main(["msp", "vtx", DEVICE]) == 0
    assert "frequency mhz  5732\n" in capsys.readouterr().out


def test_setting_it(firmware, configs, capsys):
    assert main(["msp", "vtx", DEVICE, "--channel", "4", "--pit", "on"]) == 0
    out, err = capsys.readouterr()
    assert out == "BF_VTX_CHANNEL: 3 → 4\nBF_VTX_PIT: 0 → 1\n"
    assert err.startswith("not saved")
    assert (configs[-1].band, configs[-1].channel, configs[-1].pit_mode) == (5, 4, True)
    assert main(["msp", "vtx", DEVICE, "--band", "99"]) == 1


def test_a_controller_without_a_transmitter(firmware, capsys):
    assert main(["msp", "vtx", DEVICE]) == 1
    assert "has no video transmitter" in capsys.readouterr().err
