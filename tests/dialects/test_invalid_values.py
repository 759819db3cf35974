"""Invalid values and multipliers."""

import math

import pytest

from mavstack.dialects import Dialect, common
from mavstack.dialects.invalid_values import invalid_elements, is_invalid, scaled_value


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    path = tmp_path_factory.mktemp("xml") / "own.xml"
    fields = {
        "u": ("uint16_t", "UINT16_MAX"),
        "i": ("int8_t", "INT8_MIN"),
        "h": ("uint32_t", "0xFFFF"),
        "f": ("float", "NaN"),
        "e": ("uint8_t", "E_NONE"),
        "all": ("float[3]", "[NaN:]"),
        "each": ("uint8_t[3]", "[0]"),
        "position": ("int16_t[3]", "[1,,INT16_MAX]"),
        "first": ("int16_t[3]", "[0,]"),
        "never": ("uint8_t", "nonsense"),
        "text": ("char[4]", "0"),
    }
    inside = "".join(
        f'<field type="{kind}" name="{name}" invalid="{invalid}" enum="{"E" if name == "e" else ""}"/>'
        for name, (kind, invalid) in fields.items()
    )
    enum = '<enum name="E"><entry name="E_NONE" value="3"/><entry name="E_SOME" value="4"/></enum>'
    inside += '<field type="uint8_t" name="m" multiplier="1E-2" units="V"/>'
    message = f'<message id="9" name="OWN">{inside}</message>'
    path.write_text(f"<mavlink><enums>{enum}</enums><messages>{message}</messages></mavlink>")
    return Dialect.from_xml(path)["OWN"]


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        ("u", 65535, (True,)),
        ("u", 65534, (False,)),
        ("i", -128, (True,)),
        ("i", 127, (False,)),
        ("h", 65535, (True,)),
        ("f", math.nan, (True,)),
        ("f", 0, (False,)),
        ("e", 3, (True,)),
        ("e", 4, (False,)),
        ("all", [math.nan, 1, 2], (True, True, True)),
        ("all", [1, math.nan, 2], (False, False, False)),
        ("each", [0, 5, 0], (True, False, True)),
        ("position", [1, 0, 32767], (True, False, True)),
        ("position", [32767, 1, 1], (False, False, False)),
        ("first", [0, 0, 0], (True, False, False)),
        ("never", 0, (False,)),
        ("text", "0", (False,)),
        ("m", 0, (False,)),
    ],
)
def test_invalid_values(own, field, value, expected):
    message = own(**{field: value})
    assert invalid_elements(message, field) == expected
    assert is_invalid(message, field) == all(expected)


def test_multipliers(own):
    assert scaled_value(own(m=250), "m") == 2.5
    assert scaled_value(own(u=65535), "u") is None
    assert scaled_value(own(u=3), "u") == 3
    assert scaled_value(own(each=[0, 5]), "each") == (None, 5, None)


def test_every_invalid_value_of_the_official_files_is_parsed():
    for message_class in Dialect.load("all"):
        message = message_class()
        for name in message_class.__match_args__:
            assert len(invalid_elements(message, name)) == max(
                message_class.definition.field(name).array_length, 1
            ) or (message_class.definition.field(name).type == "char")
    battery = common.BatteryStatus(voltages=[3700, 65535] + [0] * 8, current_battery=-1)
    assert invalid_elements(battery, "voltages")[:2] == (False, True)
    assert is_invalid(battery, "current_battery")
