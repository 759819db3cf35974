"""The Python interface of messages."""

import copy
import json
import math
import pickle
import struct

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mavstack.dialects import Dialect, Message, ardupilotmega, common
from mavstack.dialects.message import shortest_float
from mavstack.errors import FieldNameError, FieldRangeError, FieldTypeError

ALL = Dialect.load("all")
TEST_TYPES = Dialect.load("test")["TEST_TYPES"]


def test_fields_not_given_are_zero():
    attitude = common.Attitude(roll=0.5)
    assert (attitude.time_boot_ms, attitude.roll, attitude.yaw) == (0, 0.5, 0.0)


def test_fields_may_be_given_by_position_in_the_order_of_the_definition():
    assert common.Attitude(7, 0.5).roll == 0.5
    with pytest.raises(FieldNameError, match="7 fields"):
        common.Attitude(*range(8))


def test_a_wrong_field_name_raises_with_the_known_names():
    with pytest.raises(FieldNameError, match=r"Attitude has no field rol; .*roll"):
        common.Attitude(rol=1)  # type: ignore[call-arg]
    with pytest.raises(AttributeError):
        common.Attitude().rol = 1
    with pytest.raises(AttributeError):
        _ = common.Attitude().rol


def test_a_wrong_field_name_is_a_type_error():
    with pytest.raises(TypeError):
        common.Attitude(rol=1)  # type: ignore[call-arg]


NUMBERS = {
    "u8": 200,
    "s8": -7,
    "u16": 65_000,
    "s16": -9,
    "u32": 2**32 - 1,
    "s32": -5,
    "u64": 2**64 - 1,
    "s64": -3,
}
REFUSED = {"u8": 256, "s8": -129, "u16": 1.5, "s16": 2**70, "u32": -1, "s32": "7", "u64": -1, "s64": 2**63}


@pytest.mark.parametrize("names", [["u64", "f", "u8", "s32"], ["d", "s64", "s16"], ["c", "u16", "s8"], []])
def test_calls_at_one_place_of_a_program_give_the_same_messages_as_others(names):
    values = {**NUMBERS, "f": 0.1, "d": math.inf, "c": "x"}
    arguments = ", ".join(f"{name}=at[{name!r}]" for name in names)
    build = eval(f"lambda at: make({arguments})", {"make": TEST_TYPES})
    expected = TEST_TYPES(**{name: values[name] for name in names})
    for _ in range(4):
        assert build(values) == expected
    for name in names:
        for number in (0, True, 1.0 if name in "fd" else 1):
            other = {**values, name: "y" if name == "c" else number}
            assert build(other) == TEST_TYPES(**{name: other[name] for name in names})
        if name in REFUSED:
            with pytest.raises((FieldRangeError, FieldTypeError), match=name):
                build({**values, name: REFUSED[name]})


def test_a_field_given_twice_raises_at_every_call():
    for _ in range(4):
        assert common.Attitude(7, roll=0.5, pitch=2.0) == common.Attitude(7, 0.5, 2.0)
        with pytest.raises(FieldNameError, match="roll twice"):
            common.Attitude(7, 0.5, roll=0.5, pitch=2.0)


@pytest.mark.parametrize(
    ("field", "low", "high"),
    [
        ("u8", 0, 2**8 - 1),
        ("s8", -(2**7), 2**7 - 1),
        ("u16", 0, 2**16 - 1),
        ("s16", -(2**15), 2**15 - 1),
        ("u32", 0, 2**32 - 1),
        ("s32", -(2**31), 2**31 - 1),
        ("u64", 0, 2**64 - 1),
        ("s64", -(2**63), 2**63 - 1),
    ],
)
def test_integers_out_of_range_raise_with_the_range(field, low, high):
    for value in (low, 0, high):
        assert getattr(TEST_TYPES(**{field: value}), field) == value
    for value in (low - 1, high + 1, 2**100, -(2**100)):
        with pytest.raises(FieldRangeError, match=f"{low}.*{high}"):
            TEST_TYPES(**{field: value})
        message = TEST_TYPES()
        with pytest.raises(ValueError, match=field):
            setattr(message, field, value)
        assert getattr(message, field) == 0
        with pytest.raises(FieldRangeError):
            TEST_TYPES(**{f"{field}_array": [0, value]})


@pytest.mark.parametrize("value", ["1", None, 1.5, b"1", [1], object()])
def test_integer_fields_refuse_other_types(value):
    with pytest.raises(FieldTypeError, match="u16"):
        TEST_TYPES(u16=value)


@pytest.mark.parametrize("value", ["1", None, b"1", [1.0], object()])
def test_float_fields_refuse_other_types(value):
    with pytest.raises(TypeError, match=r"TestTypes\.f "):
        TEST_TYPES(f=value)


def test_a_float_too_large_for_the_wire_raises_but_infinity_does_not():
    with pytest.raises(FieldRangeError, match=r"3\.4028235e38"):
        TEST_TYPES(f=1e39)
    assert TEST_TYPES(f=math.inf, d=1e300).f == math.inf
    assert math.isnan(TEST_TYPES(f=math.nan).f)


def test_strings():
    assert common.Statustext(text="hello").text == "hello"
    assert common.Statustext(text=b"hello\0junk").text == "hello"
    assert common.Statustext(text="x" * 50).text == "x" * 50
    assert common.Statustext(text="grüße").text == "grüße"
    with pytest.raises(FieldRangeError, match="50"):
        common.Statustext(text="x" * 51)
    with pytest.raises(FieldTypeError):
        common.Statustext(text=5)


def test_a_text_truncated_inside_a_character_is_read():
    payload = bytes([0]) + b"x" + "é".encode()[:1] + bytes(48)
    message = common.Statustext.from_payload(payload)
    assert message.text == "x"
    assert common.Statustext.from_json(message.to_json()).text == "x"
    broken = common.Statustext.from_payload(b"\x00" + b"\xff" * 50)
    assert common.Statustext.from_json(broken.to_json()).text == "?" * 50


def test_arrays():
    message = TEST_TYPES(u8_array=[1, 2], u16_array=(3,), f_array=range(3), s="ab", c="z")
    assert message.u8_array == b"\x01\x02\x00"
    assert message.u16_array == (3, 0, 0)
    assert message.f_array == (0.0, 1.0, 2.0)
    assert (message.s, message.c) == ("ab", "z")
    with pytest.raises(FieldRangeError, match="3"):
        TEST_TYPES(u16_array=[1, 2, 3, 4])
    for wrong in ("abc", 5, None):
        with pytest.raises(FieldTypeError):
            TEST_TYPES(u16_array=wrong)


def test_bytes_fields_accept_all_bytes_like_objects():
    for data in (b"abc", bytearray(b"abc"), memoryview(b"abc"), [97, 98, 99]):
        assert common.FileTransferProtocol(payload=data).payload[:4] == b"abc\0"


def test_enum_fields_read_as_members_and_unknown_values_as_integers():
    heartbeat = common.Heartbeat(type=2, autopilot=200, base_mode=0)
    assert heartbeat.type is common.MavType.QUADROTOR
    assert type(heartbeat.autopilot) is int
    assert heartbeat.autopilot == 200
    assert isinstance(heartbeat.base_mode, common.MavModeFlag)
    heartbeat.base_mode = common.MavModeFlag.SAFETY_ARMED | 1
    assert common.MavModeFlag.SAFETY_ARMED in heartbeat.base_mode
    with pytest.raises(FieldTypeError):
        common.Heartbeat(type="MAV_TYPE_QUADROTOR")
    with pytest.raises(FieldRangeError):
        common.Heartbeat(type=256)


def test_arrays_of_enum_values_read_as_tuples_of_members():
    message_class = next(m for m in ALL if any(f.enum and f.array_length for f in m.definition.fields))
    field = next(f for f in message_class.definition.fields if f.enum and f.array_length)
    enum = ALL.enums[field.enum]
    assert all(isinstance(value, enum) for value in getattr(message_class(), field.name))


def test_a_heartbeat_has_the_protocol_version_by_default():
    assert common.Heartbeat().mavlink_version == 3
    assert common.Heartbeat(mavlink_version=1).mavlink_version == 1
    assert common.Heartbeat(0, 0, 0, 0, 0, 2).mavlink_version == 2
    assert common.Heartbeat.from_payload(b"\x01").mavlink_version == 0
    assert isinstance(common.Heartbeat(), common.Heartbeat)


def test_match_by_class_keyword_and_position():
    match common.Attitude(time_boot_ms=5, roll=0.25):
        case ardupilotmega.Attitude(roll=roll):
            assert roll == 0.25
        case _:
            pytest.fail("no match")
    match common.Attitude(5, 0.25):
        case common.Attitude(5, roll):
            assert roll == 0.25
        case _:
            pytest.fail("no match")


def test_repr_is_short_and_can_be_evaluated():
    heartbeat = common.Heartbeat(type=2, base_mode=129, system_status=99)
    text = repr(heartbeat)
    assert "type=MavType.QUADROTOR" in text
    assert "base_mode=MavModeFlag.SAFETY_ARMED|MavModeFlag.CUSTOM_MODE_ENABLED" in text
    assert "system_status=99" in text
    names = {name: getattr(common, name) for name in ("Heartbeat", "MavType", "MavAutopilot", "MavModeFlag")}
    assert eval(text, names) == heartbeat
    assert "roll=0.1," in repr(common.Attitude(roll=0.1))
    assert "q=(1.0, 0.1, 0.0, 0.0)" in repr(common.AttitudeTarget(q=[1, 0.1]))


def test_equality():
    assert common.Attitude(roll=0.1) == common.Attitude(roll=0.1)
    assert common.Attitude(roll=0.1) != common.Attitude(roll=0.2)
    assert common.Attitude() != common.AttitudeQuaternion()
    assert common.Attitude() != "Attitude"
    assert common.CommandLong(command=400) == ardupilotmega.CommandLong(command=400)
    with pytest.raises(TypeError):
        hash(common.Attitude())


def test_replace_and_copies_do_not_change_the_original():
    first = common.Attitude(roll=0.5, yaw=1)
    assert first.replace(roll=2) == common.Attitude(roll=2, yaw=1)
    for other in (copy.copy(first), copy.deepcopy(first), first.replace()):
        assert other == first
        other.roll = 9
        assert first.roll == 0.5
    with pytest.raises(FieldNameError, match="rol"):
        first.replace(rol=1)
    with pytest.raises(FieldNameError):
        first.replace(definition=1)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_pickle(protocol):
    for message in (
        common.Attitude(roll=0.1),
        ardupilotmega.CommandLong(command=42000),
        common.Heartbeat(type=2),
    ):
        copied = pickle.loads(pickle.dumps(message, protocol))
        assert type(copied) is type(message)
        assert copied == message


def test_pickle_of_a_custom_message(tmp_path):
    path = tmp_path / "own.xml"
    path.write_text(
        '<mavlink><enums><enum name="E"><entry name="E_A" value="1"/><entry name="E_B" value="2"/></enum>'
        "</enums>"
        '<messages><message id="9" name="OWN">'
        '<field type="int8_t" name="class"/><field type="uint8_t" name="e" enum="E"/>'
        "</message></messages></mavlink>"
    )
    message = Dialect.from_xml(path)["OWN"](class_=-3, e=2)
    copied, member = pickle.loads(pickle.dumps((message, message.e)))
    assert copied == message
    assert type(copied) is type(message)
    assert member is message.e


def test_dictionaries():
    message = common.Heartbeat(type=2, base_mode=128, autopilot=200)
    assert message.to_dict()["type"] is common.MavType.QUADROTOR
    assert type(message.to_dict(enums="value")["type"]) is int
    named = message.to_dict(enums="name")
    assert named["type"] == "MAV_TYPE_QUADROTOR"
    assert named["base_mode"] == "MAV_MODE_FLAG_SAFETY_ARMED"
    assert named["autopilot"] == 200
    for form in ("member", "value", "name"):
        assert common.Heartbeat.from_dict(message.to_dict(enums=form)) == message
    assert common.Attitude.from_dict({"roll": 0.5}) == common.Attitude(roll=0.5)
    with pytest.raises(FieldNameError):
        common.Attitude.from_dict({"rol": 0.5})
    with pytest.raises(FieldTypeError, match="MAV_TYPE has no entry 'MAV_TYPE_SAUCER'"):
        common.Heartbeat.from_dict({"type": "MAV_TYPE_SAUCER"})


def strict(text):
    """Parse standard JSON only, without NaN and Infinity."""
    return json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))


def test_json_keeps_nan_and_infinities():
    message = common.AttitudeTarget(q=[math.nan, math.inf, -math.inf, 0.1], thrust=math.nan)
    fields = strict(message.to_json())
    assert fields["q"] == ["NaN", "Infinity", "-Infinity", 0.1]
    assert common.AttitudeTarget.from_json(message.to_json()) == message


def test_json_of_bytes_strings_large_integers_and_enums():
    message = TEST_TYPES(u64=2**64 - 1, s64=-(2**63), s='a"b', u8_array=b"\x01\xff", d=0.1)
    fields = strict(message.to_json())
    assert (fields["u64"], fields["s64"], fields["s"], fields["d"]) == (2**64 - 1, -(2**63), 'a"b', 0.1)
    assert fields["u8_array"] == [1, 255, 0]
    assert TEST_TYPES.from_json(message.to_json()) == message
    heartbeat = common.Heartbeat(base_mode=129 | 2)
    assert strict(heartbeat.to_json())["base_mode"] == 131
    named = strict(heartbeat.to_json(enums="name"))["base_mode"]
    assert named == "MAV_MODE_FLAG_SAFETY_ARMED|MAV_MODE_FLAG_TEST_ENABLED|MAV_MODE_FLAG_CUSTOM_MODE_ENABLED"
    assert common.Heartbeat.from_json(heartbeat.to_json(enums="name")) == heartbeat
    with pytest.raises(FieldTypeError):
        common.Heartbeat.from_json("[1]")


@pytest.mark.parametrize("message_class", list(ALL), ids=lambda item: item.__name__)
def test_every_message_survives_every_conversion(message_class):
    length = message_class.definition.length
    message = message_class.from_payload(bytes(index % 63 + 32 for index in range(length)))
    assert pickle.loads(pickle.dumps(message)) == message
    assert copy.deepcopy(message) == message
    assert message_class.from_payload(message.to_payload()) == message
    for form in ("member", "value", "name"):
        assert message_class.from_dict(message.to_dict(enums=form, secrets=True)) == message
    for form in ("value", "name"):
        assert message_class.from_json(message.to_json(enums=form, secrets=True)) == message
    assert repr(message).startswith(f"{message_class.__name__}(")
    assert isinstance(message, Message)


def _digits(value):
    """The number of significant digits."""
    return len(repr(value).partition("e")[0].replace(".", "").strip("-0"))


@example(999999986991104.0)
@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_the_shortest_float_has_the_same_bits(value):
    assert struct.pack("<f", shortest_float(value, "float")) == struct.pack("<f", value)
    assert _digits(shortest_float(value, "float")) <= _digits(value)


def test_payloads_are_trimmed_and_padded():
    assert common.Attitude(time_boot_ms=1).to_payload() == b"\x01"
    assert common.Attitude().to_payload() == b"\x00"
    assert common.Attitude.from_payload(b"") == common.Attitude()
    assert common.Attitude.from_payload(bytes(28) + b"newer") == common.Attitude()
    assert len(common.Statustext(id=7).to_payload(1)) == 51


def test_metadata():
    field = common.GlobalPositionInt.definition.field("lat")
    assert (field.units, field.type, field.is_integer) == ("degE7", "int32_t", True)
    assert field.value_range == (-(2**31), 2**31 - 1)
    assert common.Attitude.definition.id == 30
    assert common.Attitude.definition.origin == "common"
    assert common.MissionRequest.definition.deprecated.replaced_by == "MISSION_REQUEST_INT"
    assert common.Attitude.__doc__ == common.Attitude.definition.description != ""
    assert common.GpsStatus.definition.field("satellite_azimuth").factor == pytest.approx(360 / 255)


@pytest.mark.parametrize("make", [tuple, list])
def test_arrays_of_floats(make):
    """Tuples of floats take a shorter way in the core than other sequences; both mean the same."""
    full = common.Odometry(pose_covariance=make([0.5] * 21), q=make([math.nan, 0.1]))
    assert full.pose_covariance == (0.5,) * 21
    assert math.isnan(full.q[0])
    assert full.q[1:] == (pytest.approx(0.1), 0.0, 0.0)
    full.q = make([1.0])
    assert full.q == (1.0, 0.0, 0.0, 0.0)
    with pytest.raises(FieldRangeError, match="holds at most 4 elements"):
        full.q = make([0.0] * 5)
    with pytest.raises(FieldRangeError, match="holds at most 21 elements"):
        common.Odometry(pose_covariance=make([0.0] * 90))
    with pytest.raises(FieldRangeError, match=r"1e\+300 is outside"):
        full.q = make([2.0, 1e300])
    with pytest.raises(FieldTypeError, match=r"Odometry\.q must be a number"):
        full.q = make([2.0, "x"])
    assert full.q == (1.0, 0.0, 0.0, 0.0)
    assert common.Odometry(q=make([True, 2])).q == (1.0, 2.0, 0.0, 0.0)
