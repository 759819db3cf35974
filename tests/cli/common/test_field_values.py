from __future__ import annotations

from math import nan, pi

import pytest

from mavstack.cli.common.field_values import field_texts
from mavstack.cli.common.text import printable
from mavstack.dialects import ardupilotmega, common


def shown(message, field: str):
    return next(value for value in field_texts(message) if value.name == field)


@pytest.mark.parametrize(
    ("message", "field", "text"),
    [
        (common.Attitude(roll=pi / 2), "roll", "90.0°"),
        (common.Attitude(roll=-1e-9), "roll", "0.0°"),
        (common.Attitude(rollspeed=pi), "rollspeed", "180.0°/s"),
        (common.Attitude(time_boot_ms=1500), "time_boot_ms", "1500 ms"),
        (common.Attitude(time_boot_ms=60_500), "time_boot_ms", "60.500 s"),
        (common.GlobalPositionInt(lat=-473977418), "lat", "-47.397742°"),
        (common.GlobalPositionInt(alt=-1500), "alt", "-1.50 m"),
        (common.GlobalPositionInt(vx=123), "vx", "1.23 m/s"),
        (common.GlobalPositionInt(hdg=9050), "hdg", "90.5°"),
        (common.VfrHud(heading=359), "heading", "359°"),
        (common.SysStatus(voltage_battery=12345), "voltage_battery", "12.35 V"),
        (common.SysStatus(load=505), "load", "50.5 %"),
        (common.GpsRawInt(eph=121), "eph", "1.21"),
        (common.GpsRawInt(fix_type=3), "fix_type", "3D_FIX"),
        (common.GpsRawInt(fix_type=99), "fix_type", "99"),
        (common.RcChannels(chan1_raw=1500), "chan1_raw", "1500 µs"),
        (common.ScaledPressure(temperature=2150), "temperature", "21.5 °C"),
        (
            common.SystemTime(time_unix_usec=1_700_000_000_000_000),
            "time_unix_usec",
            "2023-11-14 22:13:20 UTC",
        ),
        (common.Heartbeat(base_mode=129), "base_mode", "SAFETY_ARMED|CUSTOM_MODE_ENABLED"),
        (common.Statustext(text="hello"), "text", "hello"),
        (common.ParamValue(param_id="ABC", param_value=0.5), "param_value", "0.5"),
        (common.EscStatus(rpm=[7, 7, 7, 7]), "rpm", "[7 rpm 7 rpm 7 rpm 7 rpm]"),
        (ardupilotmega.Rangefinder(distance=1.5), "distance", "1.50 m"),
    ],
)
def test_units_and_enum_names(message, field, text):
    assert shown(message, field).text == text


@pytest.mark.parametrize(
    ("message", "field"),
    [
        (common.GlobalPositionInt(hdg=0xFFFF), "hdg"),
        (common.SysStatus(current_battery=-1), "current_battery"),
        (common.Attitude(roll=nan), "roll"),
        (common.BatteryStatus(voltages=[0xFFFF] * 10), "voltages"),
        (common.Statustext(text=""), "text"),
    ],
)
def test_invalid_values_are_marked(message, field):
    assert not shown(message, field).known


def test_invalid_end_of_an_array_is_omitted():
    message = common.BatteryStatus(voltages=[4100, 4000, *[0xFFFF] * 8])
    assert shown(message, "voltages").text == "[4.10 V 4.00 V]"


def test_control_characters_are_removed():
    assert "\x1b" not in printable("\x1b[2J")
    message = common.Statustext(text="\x1b[31mred\n")
    assert shown(message, "text").text == "\N{REPLACEMENT CHARACTER}[31mred"


def test_every_message_can_be_shown():
    from mavstack.dialects import Dialect

    for message in Dialect.load("all"):
        assert len(field_texts(message())) == len(message.definition.fields)
