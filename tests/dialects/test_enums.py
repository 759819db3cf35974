"""Enum classes of all dialects."""

import keyword
import pickle
import random
import tracemalloc
from enum import IntEnum, IntFlag

import pytest

from mavstack.dialects import Dialect, all, ardupilotmega, common, enums, minimal  # noqa: A004
from mavstack.dialects.enums import MavFlag, enum_reader
from mavstack.dialects.names import member_names, shared_prefix
from mavstack.dialects.tables import official_names

NAMES = official_names()


def test_names_of_members():
    assert common.MavCmd.NAV_TAKEOFF == 22
    assert common.GpsFixType._3D_FIX == 3
    assert common.MavType.QUADROTOR.official_name == "MAV_TYPE_QUADROTOR"
    assert common.MavCmd.definition().entry(22).params[6].label == "Altitude"


@pytest.mark.parametrize(
    ("enum", "entries", "prefix"),
    [
        ("MAV_CMD", ["MAV_CMD_NAV_TAKEOFF", "MAV_CMD_DO_JUMP"], "MAV_CMD_"),
        ("A", ["MAV_COMP_ID_ALL", "MAV_COMP_ID_IMU"], "MAV_COMP_ID_"),
        ("A", ["RIGHT", "LEFT"], ""),
        ("A", ["A_B", "A_BC"], "A_"),
        ("A", ["A_B", "A_B_C"], "A_"),
        ("A", ["A_", "A_B"], ""),
        ("MAV_FLAGS", ["MAV_FLAG_ONE"], "MAV_"),
        ("MAV_FLAGS", ["MAV_FLAGS_ONE"], "MAV_FLAGS_"),
        ("A_B", ["A_B"], "A_"),
        ("A", [], ""),
    ],
)
def test_shared_words(enum, entries, prefix):
    assert shared_prefix(enum, entries) == prefix


def test_added_entries_do_not_change_member_names():
    names = member_names("E", ["E_A", "E_B"], ["E_C", "OTHER", "A", "E_1"], ["name"])
    assert names == {"E_A": "A", "E_B": "B", "E_C": "C", "OTHER": "OTHER", "A": "A_", "E_1": "_1"}


def test_reserved_member_names_get_an_underscore():
    names = member_names("E", ["E_name", "E_None", "E_mro", "E_2D"], [], ["name", "mro"])
    assert list(names.values()) == ["name_", "None_", "mro_", "_2D"]


@pytest.mark.parametrize("dialect_name", NAMES)
def test_every_enum_of_every_dialect(dialect_name):
    dialect = Dialect.load(dialect_name)
    for official, enum in dialect.enums.items():
        definition = dialect.enum_definition(official)
        assert issubclass(enum, IntFlag if definition.bitmask else IntEnum)
        assert len(enum.__members__) == len(definition.entries)
        members = list(enum.__members__.items())
        for entry in definition.entries:
            member = enum(entry.value)
            assert member == entry.value
            assert member.official_name == entry.name
            name = next(name for name, value in members if value is member)
            assert entry.name.endswith(name.strip("_"))
            assert name.isidentifier()
            assert not keyword.iskeyword(name)
            assert pickle.loads(pickle.dumps(member)) is member


@pytest.mark.parametrize("dialect_name", NAMES)
def test_a_member_has_the_same_name_in_all_dialects(dialect_name):
    whole = Dialect.load("all")
    for official, enum in Dialect.load(dialect_name).enums.items():
        if official in whole.enums:
            known = {member.official_name: name for name, member in whole.enums[official].__members__.items()}
            for name, member in enum.__members__.items():
                assert known[member.official_name] == name


def test_classes_are_shared_unless_a_dialect_adds_entries():
    assert ardupilotmega.MavType is common.MavType is minimal.MavType is all.MavType
    assert ardupilotmega.MavCmd is not common.MavCmd
    assert ardupilotmega.MavCmd.NAV_TAKEOFF == common.MavCmd.NAV_TAKEOFF
    assert "POWER_OFF_INITIATED" in ardupilotmega.MavCmd.__members__
    assert "POWER_OFF_INITIATED" not in common.MavCmd.__members__
    assert Dialect.load("cubepilot").enums["MAV_CMD"] is common.MavCmd
    assert Dialect.load("storm32").enums["MAV_CMD"] is not ardupilotmega.MavCmd


def test_classes_are_found_by_module_and_name():
    assert pickle.loads(pickle.dumps(ardupilotmega.MavCmd)) is ardupilotmega.MavCmd
    assert (common.MavType.__module__, common.MavType.__qualname__) == (
        "mavstack.dialects.minimal",
        "MavType",
    )


def test_an_unknown_value_raises_only_when_a_member_is_requested():
    with pytest.raises(ValueError, match="99"):
        common.MavState(99)
    assert common.Heartbeat(system_status=99).system_status == 99


def test_combinations_of_a_bitmask():
    flag = common.MavModeFlag
    both = flag.SAFETY_ARMED | flag.AUTO_ENABLED
    assert both == 132
    assert isinstance(both, flag)
    assert both.name == "SAFETY_ARMED|AUTO_ENABLED"
    assert both.official_name == "MAV_MODE_FLAG_SAFETY_ARMED|MAV_MODE_FLAG_AUTO_ENABLED"
    assert flag.AUTO_ENABLED in both
    assert flag.HIL_ENABLED not in both
    assert list(both) == [flag.SAFETY_ARMED, flag.AUTO_ENABLED]
    assert both & ~flag.SAFETY_ARMED == flag.AUTO_ENABLED
    assert isinstance(~both, flag)
    assert both ^ flag.AUTO_ENABLED is flag.SAFETY_ARMED
    assert flag(0).name is None
    assert not flag(0)
    assert flag(0).official_name == "0"
    assert flag(both) == both
    assert pickle.loads(pickle.dumps(both)) == both
    with pytest.raises(ValueError, match="x"):
        flag("x")


def test_bits_without_a_name_are_kept():
    sensors = common.MavSysStatusSensorExtended(1 << 20 | 1)
    assert sensors == 1 << 20 | 1
    assert sensors.name.endswith(f"|{1 << 20}")
    assert pickle.loads(pickle.dumps(sensors)) == sensors


def test_sixty_four_bit_masks():
    capability = common.MavProtocolCapability(2**64 - 1)
    assert capability == 2**64 - 1
    assert common.AutopilotVersion(capabilities=capability).capabilities == capability


def test_a_stream_of_random_masks_does_not_grow_memory():
    source = random.Random(1)
    message = common.SysStatus()
    enum = common.MavSysStatusSensor
    for _ in range(2000):
        message.onboard_control_sensors_health = source.getrandbits(32)
        assert isinstance(message.onboard_control_sensors_health, enum)
    known = len(enum._value2member_map_)
    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()
    for _ in range(3000):
        message.onboard_control_sensors_health = source.getrandbits(32)
        _ = message.onboard_control_sensors_health
        _ = enum(source.getrandbits(32)) | 1
    after, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(enum._value2member_map_) == known == len(enum.__members__)
    assert after - before < 400_000


def test_bitmasks_read_negative_integers_unchanged():
    members, fallback = enum_reader(common.MavModeFlag)
    assert members[128] is common.MavModeFlag.SAFETY_ARMED
    assert type(fallback(-5)) is int


def enums_of(tmp_path, text):
    path = tmp_path / "e.xml"
    path.write_text(f"<mavlink><enums>{text}</enums></mavlink>")
    return Dialect.from_xml(path).enums


def test_unusual_custom_enums(tmp_path):
    enums = enums_of(
        tmp_path,
        '<enum name="EMPTY"></enum>'
        '<enum name="NEGATIVE"><entry name="N_A" value="-1"/><entry name="N_B" value="1"/></enum>'
        '<enum name="MASK" bitmask="true"><entry name="M_A" value="-1"/><entry name="M_B" value="2"/></enum>'
        '<enum name="small"><entry name="name" value="1"/><entry name="value" value="2"/>'
        '<entry name="mro" value="3"/><entry name="_x_" value="4"/><entry name="definition" value="5"/>'
        '<entry name="real" value="6"/></enum>'
        '<enum name="class"><entry name="CLASS_1" value="1"/></enum>',
    )
    assert len(enums["EMPTY"]) == 0
    assert enums["NEGATIVE"](-1).name == "A"
    assert enums["MASK"](2).name == "B"
    assert not issubclass(enums["MASK"], MavFlag)
    assert [member.value for member in enums["small"]] == [1, 2, 3, 4, 5, 6]
    assert enums["small"](1).name == "name_"
    assert enums["class"].__name__ == "Class"
    with pytest.raises(KeyError):
        enums["NONE"]


@pytest.mark.parametrize("name", ["common", "all"])
def test_names_and_marks_are_those_of_the_definitions(name):
    dialect = Dialect.load(name)
    for official, enum in dialect.enums.items():
        entries = enum.definition().entries
        names = {entry.value: entry.name for entry in reversed(entries)}
        assert enums.official_names(enum) == names
        located = {entry.value for entry in entries if entry.has_location}
        assert enums.marked_values(dialect, official, "has_location") == located
