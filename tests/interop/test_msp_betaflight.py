"""Messages and settings against Betaflight's SITL: read, written, read back, saved, found after a restart."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from mavstack.bridges.msp import FlightController
from mavstack.dialects.common import MavParamType
from mavstack.errors import MspDenied, MspError, MspSettingError
from mavstack.msp.messages import (
    Name,
    actions,
    battery,
    config,
    gps,
    modes,
    motors,
    osd,
    pid,
    rc,
    sensors,
    vtx,
)
from mavstack.msp.messages.registry import all_messages
from tests.interop.betaflight import URL, betaflight_sitl, needs_betaflight

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack.msp.messages.layout import TableMessage
    from mavstack.msp.settings import SettingDefinition, Value

pytestmark = [pytest.mark.interop, pytest.mark.timeout(180), needs_betaflight]

#: Replies that are not asked for: their requests do something.
ACTIONS = {actions.RebootReply, actions.ResetConfReply, actions.PassthroughReply}
#: Equipment that the SITL program does not have: its commands are refused.
NOT_IN_SITL = {
    "MSP_GPSSTATISTICS",
    "MSP_ESC_SENSOR_DATA",
    "MSP_SERVO",
    "MSP_SERVO_CONFIGURATIONS",
    "MSP_SERVO_MIX_RULES",
    "MSP_DATAFLASH_READ",
    "MSP_LED_COLORS",
    "MSP_LED_STRIP_CONFIG",
    "MSP_LED_STRIP_MODECOLOR",
    "MSP2_GET_LED_STRIP_CONFIG_VALUES",
}
#: Equipment that the target leaves out by default.
SWITCHED_ON = {
    "MSP_BEEPER_CONFIG",
    "MSP_OSD_CONFIG",
    "MSP2_GET_OSD_WARNINGS",
    "MSP_VTX_CONFIG",
    "MSP_VTXTABLE_BAND",
    "MSP_VTXTABLE_POWERLEVEL",
}
#: Settings of functions that the SITL program was built without: it answers 0 and takes nothing.
BUILT_WITHOUT = re.compile("BF_(ACRO_TRN|DYN_IDLE|DYN_N_|RPM_|MOT_DSHOT|VTX_PIT$)")
#: Settings whose place BF_VTX_FREQ takes, which is set after them.
REPLACED = {"BF_VTX_BAND", "BF_VTX_CHANNEL", "BF_VTX_POWER"}
#: Values that the firmware's own checks leave as they are.
VALUES: dict[str, Value] = {
    "BF_GYRO_N1_HZ": 200,
    "BF_GYRO_N2_HZ": 300,
    "BF_DTERM_N_HZ": 250,
    "BF_FEATURES": int(config.Feature.RX_UDP | config.Feature.GPS | config.Feature.AIRMODE),
    "BF_BBOX_DEVICE": 3,
    "BF_MOT_PROTOCOL": 0,
    "BF_MOT_PWM_RATE": 400,
    "BF_PID_DENOM": 4,
}
REQUESTS: tuple[tuple[TableMessage, type[TableMessage]], ...] = (
    (config.SetRtc(1_800_000_000, 0), config.Rtc),
    (modes.SetModeRange(1, 1, 2, 1300, 1700, 0, 0), modes.ModeRanges),
    (modes.SetAdjustmentRange(0, 0, 1, 900, 2100, 1, 2, 0, 0), modes.AdjustmentRanges),
    (rc.SetRxMap((0, 1, 2, 3, 4, 5, 6, 7)), rc.RxMap),
    (motors.SetMixerConfig(3, yaw_motors_reversed=True), motors.MixerConfig),
    (motors.SetMotorOutputReordering((1, 0, 2, 3, 4, 5, 6, 7)), motors.MotorOutputReordering),
    (battery.SetVoltageMeterConfig(10, 111, 10, 1), battery.VoltageMeterConfig),
    (battery.SetCurrentMeterConfig(10, 401, 5), battery.CurrentMeterConfig),
    (sensors.SetSensorConfig(0, 1, 1, rangefinder=0, optical_flow=0), sensors.SensorConfig),
    (config.SetText(1, "Pilot"), config.NamedText),
    (gps.SetRawGps(1, 12, 47.397742, 8.545594, 488, 1.5), gps.RawGps),
    (pid.SelectSetting(1), pid.SimplifiedTuning),
)
#: Requests without a value that could be read back.
ACCEPTED: tuple[TableMessage, ...] = (
    rc.SetRawRc((1500, 1500, 1000, 1500)),
    rc.SetTxInfo(200),
    motors.SetMotor((1000,) * 8),
    sensors.SetHeading(90),
    sensors.AccCalibration(),
    sensors.MagCalibration(),
    pid.CopyProfile(0, 1, 0),
    pid.ResetCurrentPid(),
    rc.SetRxFailConfig(5, 2, 1500),
    actions.SetArmingDisabled(is_disabled=True),
)


def argument_of(message: type[TableMessage]) -> bytes:
    return b"\1" if message is config.NamedText or "VTXTABLE" in message.NAME else b""


def another_value(definition: SettingDefinition, value: Value) -> Value:
    step = definition.increment
    wanted = VALUES.get(definition.name, value + step if value + step <= definition.maximum else value - step)
    limited = min(max(wanted, definition.minimum), definition.maximum)
    return limited if definition.type is MavParamType.REAL32 else int(limited)


@pytest.mark.smoke
async def test_every_reply_decodes_and_encodes_to_the_same_bytes(tmp_path: Path) -> None:
    asked = [
        reply
        for reply in all_messages()
        if reply.IS_REPLY and "BTFL" in reply.VARIANTS and reply not in ACTIONS
    ]
    refused, different = set(), []
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        async with FlightController(URL) as controller:
            for reply in asked:
                try:
                    payload = await controller.request(reply.COMMAND, argument_of(reply))
                except MspDenied:
                    refused.add(reply.NAME)
                    continue
                if payload or reply is not osd.OsdCanvas:  # which is empty without a display
                    again = reply.decode(payload, controller.info).encode(controller.info)
                    different += [reply.NAME] if again != payload else []
    assert different == []
    assert NOT_IN_SITL <= refused <= NOT_IN_SITL | SWITCHED_ON
    assert len(asked) - len(refused) >= 50


async def test_every_setting_is_read_written_saved_and_found_after_a_restart(tmp_path: Path) -> None:
    written: dict[str, Value] = {}
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        async with FlightController(URL) as controller:
            values = await controller.settings.all()
            for definition in controller.settings.definitions():
                name = definition.name
                if name not in values:
                    assert definition.read.NAME in NOT_IN_SITL | SWITCHED_ON
                elif BUILT_WITHOUT.match(name):
                    with pytest.raises(MspSettingError, match=f"writing {name} of .*, read 0 back"):
                        await controller.settings.set(name, another_value(definition, values[name]))
                else:
                    written[name] = await controller.settings.set(
                        name, another_value(definition, values[name])
                    )
            unsaved = await controller.settings.all()
            await controller.settings.save()
        await sitl.restart()
        async with FlightController(URL) as controller:
            found = await controller.settings.all()
    assert {name: value for name, value in written.items() if values[name] == value}.keys() <= VALUES.keys()
    assert {name for name, value in written.items() if unsaved[name] != value} <= REPLACED
    assert {name for name, value in written.items() if found[name] != value} <= REPLACED
    assert len(written) >= 105


async def test_band_channel_and_power_of_a_video_transmitter_with_a_table(tmp_path: Path) -> None:
    band = vtx.SetVtxTableBand(1, "RACEBAND", "R", False, (5658, 5695, 5732, 5769, 5806, 5843, 5880, 5917))
    level = vtx.SetVtxTablePowerLevel(2, 200, "200")
    wanted = {"BF_VTX_BAND": 1, "BF_VTX_CHANNEL": 3, "BF_VTX_POWER": 2}
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        async with FlightController(URL) as controller:
            try:
                present = await controller.get(vtx.VtxConfig)
            except MspDenied:
                pytest.skip("the SITL program was built without a video transmitter")
            sizes = {"table_bands": 1, "table_channels": 8, "table_powers": 2}
            await controller.send(vtx.SetVtxConfig.from_message(present, **sizes, clear_table=True))
            for message in (band, level):
                await controller.send(message)
            for name, value in wanted.items():
                assert await controller.settings.set(name, value) == value
            await controller.settings.save()
        await sitl.restart()
        async with FlightController(URL) as controller:
            assert await controller.get(
                vtx.VtxTableBand, vtx.GetVtxTableBand(1)
            ) == vtx.VtxTableBand.from_message(band)
            stored = await controller.get(vtx.VtxTablePowerLevel, vtx.GetVtxTablePowerLevel(2))
            assert stored == vtx.VtxTablePowerLevel.from_message(level)
            found = await controller.settings.all()
    assert {name: found[name] for name in wanted} == wanted


async def test_settings_that_are_not_saved_are_lost(tmp_path: Path) -> None:
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        async with FlightController(URL) as controller:
            before = await controller.settings.get("BF_PID_ROLL_P")
            assert await controller.settings.set("BF_PID_ROLL_P", before + 5) == before + 5
        await sitl.restart()
        async with FlightController(URL) as controller:
            assert await controller.settings.get("BF_PID_ROLL_P") == before


async def test_every_request_is_accepted_and_changes_its_reply(tmp_path: Path) -> None:
    unchanged = []
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        async with FlightController(URL) as controller:
            await controller.send(config.SetName("Kestrel"))
            assert (await controller.get(Name)).name == "Kestrel"
            for message, reply in REQUESTS:
                before = await controller.request(reply.COMMAND, argument_of(reply))
                await controller.send(message)
                after = await controller.request(reply.COMMAND, argument_of(reply))
                unchanged += [message.NAME] if after == before else []
            refused = []
            for message in ACCEPTED:
                try:
                    await controller.send(message)
                except MspError as error:
                    refused.append(str(error))
    assert refused == []
    assert unchanged == ["MSP_SELECT_SETTING"]  # the profiles are equal at first
