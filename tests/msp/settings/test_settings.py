from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError, MspFirmwareError
from mavstack.msp import FirmwareInfo
from mavstack.msp.messages.filters import FilterConfig, SetFilterConfig
from mavstack.msp.messages.osd import SetOsdConfig, SetOsdItem, SetOsdTimer
from mavstack.msp.messages.pid import Gains, Pid
from mavstack.msp.messages.rc import RcTuning, SetRcTuning
from mavstack.msp.messages.vtx import SetVtxConfig, VtxConfig, VtxType
from mavstack.msp.settings import Settings, tables
from mavstack.msp.settings.definition import NAME_LENGTH
from mavstack.msp.settings.tables import ALL_SETTINGS
from tests.msp.messages.strategies import records

if TYPE_CHECKING:
    from pathlib import Path

BETAFLIGHT = FirmwareInfo("BTFL", (4, 5, 1), (1, 46))
NEWEST = FirmwareInfo("BTFL", (26, 12, 0), (1, 49))
INAV = FirmwareInfo("INAV", (8, 0, 0), (2, 5))
FIRMWARES = (FirmwareInfo("BTFL", (4, 0, 0), (1, 41)), BETAFLIGHT, NEWEST, INAV)
AXES = {"ROLL", "PITCH", "YAW", "ALT", "POS", "POSR", "NAVR", "LEVEL", "MAG", "VEL"}
VTX = VtxConfig(VtxType.SMARTAUDIO, 3, 2, 1, False, 5740, True, 0, 0, True, 5, 8, 4)


@pytest.mark.parametrize("firmware", FIRMWARES, ids=lambda firmware: f"{firmware.variant}-{firmware.api}")
def test_names_are_unique_and_short(firmware: FirmwareInfo) -> None:
    settings = Settings(firmware)
    names = Counter(name for item in settings.definitions for name in (item.name, *item.aliases))
    assert names.most_common(1)[0][1] == 1
    assert len(settings.definitions) >= 105
    for item in settings.definitions:
        assert len(item.name) <= NAME_LENGTH
        assert item.minimum < item.maximum, item.name
        assert item.description
        assert not item.description.endswith(".")


def test_names_and_commands_that_programs_rely_on() -> None:
    names = {name for item in ALL_SETTINGS for name in (item.name, *item.aliases)}
    assert names >= {f"BF_PID_{axis}_{term}" for axis in AXES for term in "PID"}
    assert names >= {f"BF_PID_{axis}_F" for axis in ("ROLL", "PITCH", "YAW")}
    assert names >= {"BF_RC_RATE", "BF_RC_EXPO", "BF_RATE_RC_EXPO", "BF_OSD_ITEM_0_POS", "BF_FEATURES"}
    commands = {(item.read.COMMAND, item.write.COMMAND) for item in ALL_SETTINGS}
    pairs = {(112, 202), (94, 95), (111, 204), (92, 93), (90, 91), (131, 222), (32, 33), (36, 37), (75, 76)}
    assert commands >= pairs | {(61, 62), (184, 185), (132, 223), (135, 225), (80, 81), (88, 89), (84, 85)}


def test_facts_of_a_line_of_the_file() -> None:
    rate, old, new, limit, warnings = (
        next(item for item in ALL_SETTINGS if item.name == name)
        for name in ("BF_RC_RATE", "BF_TPA_RATE_OLD", "BF_ANTI_GRAV_G", "BF_THR_LIM_TYPE", "BF_OSD_WARNINGS")
    )
    assert (rate.minimum, rate.maximum, rate.aliases, rate.variants) == (
        1,
        255,
        ("BF_RATE_RC_RATE",),
        ("BTFL",),
    )
    assert (rate.read, rate.write) == (RcTuning, SetRcTuning)
    assert (old.until, new.since) == ("1.44", "1.45")
    assert (limit.values, limit.maximum) == ({0: "off", 1: "scale", 2: "clip"}, 2)
    assert warnings.build is not None


def test_wrong_lines_of_the_file_are_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tables, "files", lambda package: tmp_path)
    line = "NAME | rc_rate | {} | {} | A rate"
    for values, options in (("1-255", ""), ("1..2..3", ""), ("low", ""), ("", "untill=1.44"), ("", "since")):
        (tmp_path / "settings.txt").write_text("[RcTuning SetRcTuning]\n" + line.format(values, options))
        with pytest.raises((ValueError, TypeError)):
            list(tables._read_settings())


def test_values_of_messages() -> None:
    settings = Settings(BETAFLIGHT)
    pid = Pid((Gains(45, 80, 30),))
    assert settings.values({Pid: pid}) == {"BF_PID_ROLL_P": 45, "BF_PID_ROLL_I": 80, "BF_PID_ROLL_D": 30}
    assert settings.reads(["BF_PID_ROLL_P", "BF_PID_YAW_D", "BF_RATE_RC_EXPO"]) == (Pid, RcTuning)


def test_the_message_that_changes_a_setting() -> None:
    tuning = RcTuning.decode(bytes(range(24)), BETAFLIGHT)
    changed = Settings(BETAFLIGHT).change(tuning, "BF_RATE_RC_EXPO", 50)
    assert isinstance(changed, SetRcTuning)
    assert changed.encode(BETAFLIGHT) == bytes([0, 50, *range(2, 23)])


def test_a_low_pass_above_255_also_fills_its_old_byte() -> None:
    filters = FilterConfig.decode(bytes(56), NEWEST)
    changed = Settings(NEWEST).change(filters, "BF_GYRO_LPF1_HZ", 500)
    assert isinstance(changed, SetFilterConfig)
    assert (changed.gyro_lpf1_static_hz, changed.gyro_lpf1_static_hz_8) == (500, 255)


def test_band_and_frequency_of_the_video_transmitter() -> None:
    settings = Settings(BETAFLIGHT)
    by_band = settings.change(VTX, "BF_VTX_BAND", 5)
    by_frequency = settings.change(VTX, "BF_VTX_FREQ", 5800)
    assert isinstance(by_band, SetVtxConfig)
    assert isinstance(by_frequency, SetVtxConfig)
    assert (by_band.combined, by_band.band, by_band.channel, by_band.power) == (33, 5, 2, 1)
    assert (by_frequency.combined, by_frequency.band, by_frequency.frequency) == (5800, 0, 5800)
    assert by_band.table_bands is None  # the table of bands stays


@pytest.mark.properties
@given(data=st.data(), firmware=st.sampled_from(FIRMWARES))
def test_a_setting_that_is_written_changes_nothing_else(data: st.DataObject, firmware: FirmwareInfo) -> None:
    settings = Settings(firmware)
    item = data.draw(st.sampled_from(settings.definitions))
    if item.write in (SetOsdItem, SetOsdTimer, SetOsdConfig, SetVtxConfig, SetFilterConfig):
        return
    current = data.draw(records(item.read, firmware))
    if item.value_in(current) is None:
        return
    changed = settings.change(current, item.name, item.minimum)
    for name in (field for field in type(changed).__dataclass_fields__ if hasattr(current, field)):
        if name != item.path.field:
            assert getattr(changed, name) == getattr(current, name)
    assert item.path.get(changed) == pytest.approx(item.minimum)


def test_settings_that_a_firmware_does_not_have_are_refused_with_the_reason() -> None:
    with pytest.raises(InvalidArgumentError, match=r"there is no setting .BF_WINGS."):
        Settings(BETAFLIGHT).find("BF_WINGS")
    with pytest.raises(
        MspFirmwareError, match=r"setting BF_THR_HOVER of it failed: it needs version 1\.47 of MSP"
    ):
        Settings(BETAFLIGHT, "it").find("BF_THR_HOVER")
    with pytest.raises(MspFirmwareError, match="iNav does not have it"):
        Settings(INAV).find("BF_RC_RATE")


def test_firmwares_whose_layouts_are_too_old_have_no_settings() -> None:
    old = Settings(FirmwareInfo("BTFL", (3, 5, 7), (1, 39)), "it")
    assert old.definitions == ()
    with pytest.raises(
        MspFirmwareError, match=r"Betaflight 3.5.7 has version 1.39 of MSP, settings need 1.40"
    ):
        old.find("BF_PID_ROLL_P")


def test_settings_of_an_unknown_firmware_are_read_and_not_written() -> None:
    settings = Settings(FirmwareInfo("EMUF", (0, 4, 0), (1, 54)), "it")
    pid = Pid((Gains(45, 80, 30),))
    assert settings.values({Pid: pid})["BF_PID_ROLL_P"] == 45
    with pytest.raises(MspFirmwareError, match="settings of EMUF are only read"):
        settings.change(pid, "BF_PID_ROLL_P", 46)


def test_settings_that_the_firmware_does_not_send_are_not_written() -> None:
    with pytest.raises(
        MspFirmwareError, match="writing setting BF_PID_YAW_P of it failed: the firmware does not"
    ):
        Settings(BETAFLIGHT, "it").change(Pid((Gains(45, 80, 30),)), "BF_PID_YAW_P", 46)
