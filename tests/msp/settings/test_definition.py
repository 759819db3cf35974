from __future__ import annotations

import pytest

from mavstack.dialects.common import MavParamType
from mavstack.errors import InvalidArgumentError
from mavstack.msp import FirmwareInfo
from mavstack.msp.messages.pid import Gains, Pid, SetPid
from mavstack.msp.messages.rc import FailsafeConfig, SetFailsafeConfig
from mavstack.msp.messages.sensors import RawImu
from mavstack.msp.settings.definition import FieldPath, SettingDefinition, define

PID = Pid((Gains(45, 80, 30), Gains(47, 84, 34)))


def gain(path: str = "controllers[1].i") -> SettingDefinition:
    return define("TEST_I", path, "A gain", 0, 250, messages=(Pid, SetPid))


def delay() -> SettingDefinition:
    messages = (FailsafeConfig, SetFailsafeConfig)
    return define("TEST_DELAY", "delay", "A time", 0.1, 20.0, messages=messages)


@pytest.mark.parametrize(
    ("text", "path"),
    [("delay", FieldPath("delay")), ("items[3]", FieldPath("items", 3)), ("a[0].p", FieldPath("a", 0, "p"))],
)
def test_paths(text: str, path: FieldPath) -> None:
    assert FieldPath.parse(text) == path


@pytest.mark.parametrize("wrong", ["", "a[", "a[x]", "a.b.c"])
def test_wrong_paths_are_refused(wrong: str) -> None:
    with pytest.raises(InvalidArgumentError):
        FieldPath.parse(wrong)


def test_a_setting_in_a_list() -> None:
    assert (gain().value_in(PID), gain("controllers[2].i").value_in(PID)) == (84, None)
    assert gain().message(PID, 90) == SetPid((Gains(45, 80, 30), Gains(47, 90, 34)))
    assert (gain().type, gain().increment, gain().unit) == (MavParamType.UINT8, 1, "")


def test_a_scaled_setting_is_a_float_with_the_unit_of_its_field() -> None:
    setting = delay()
    assert (setting.type, setting.increment, setting.unit) == (MavParamType.REAL32, 0.1, "s")
    assert setting.is_equal(1.5, 1.5000000596046448)
    assert not setting.is_equal(1.5, 1.6)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (251, "TEST_I must be 0 to 250, got 251"),
        (-1, "TEST_I must be 0 to 250, got -1"),
        (1.5, "TEST_I must be an integer, got 1.5"),
        ("high", "TEST_I must be a number, got 'high'"),
        (float("nan"), "TEST_I must be a number, got nan"),
    ],
)
def test_values_outside_the_range_are_refused(value: object, text: str) -> None:
    with pytest.raises(InvalidArgumentError, match=text):
        gain().checked(value)


def test_values_within_the_range_have_the_type_of_the_setting() -> None:
    assert (gain().checked(True), gain().checked(7.0)) == (1, 7)
    assert delay().checked(20.000001) == pytest.approx(20.0)
    with pytest.raises(InvalidArgumentError, match=r"TEST_DELAY must be 0.1 to 20 s, got 21"):
        delay().checked(21)


def test_versions_and_firmwares() -> None:
    setting = define(
        "TEST",
        "controllers[0].p",
        "A gain",
        messages=(Pid, SetPid),
        variants=("BTFL",),
        since="1.42",
        until="1.45",
    )
    old, new = FirmwareInfo("BTFL", (4, 1, 0), (1, 41)), FirmwareInfo("BTFL", (4, 5, 1), (1, 46))
    assert setting.is_in(FirmwareInfo("BTFL", (4, 4, 0), (1, 45)))
    assert setting.absence(old) == "it needs version 1.42 of MSP, Betaflight 4.1.0 has version 1.41 of MSP"
    assert (
        setting.absence(new) == "it ends with version 1.45 of MSP, Betaflight 4.5.1 has version 1.46 of MSP"
    )
    assert setting.absence(FirmwareInfo("INAV", api=(2, 5))) == "iNav does not have it"


def test_a_field_that_is_no_number_is_refused() -> None:
    from mavstack.msp.messages.config import NamedText, SetText

    with pytest.raises(InvalidArgumentError, match=r"MSP2_GET_TEXT.text is not a number"):
        define("TEST", "text", "A text", messages=(NamedText, SetText))
    assert define("TEST", "rates[0]", "A rate", messages=(RawImu, SetText)).type is MavParamType.INT16
