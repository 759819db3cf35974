"""Dialects: loading, lookup, sharing of classes, several versions at the same time."""

import pickle
import shutil
from pathlib import Path

import pytest

import mavstack.dialects
from mavstack.dialects import Dialect, Message, all, ardupilotmega, asluav, common, minimal, storm32  # noqa: A004
from mavstack.dialects.compare import compare
from mavstack.dialects.tables import official_names
from mavstack.errors import DialectError, UnknownDialectError, UnknownMessageError

DEFINITIONS = Path(mavstack.dialects.__file__).parent / "definitions"


def test_loading_by_name_in_any_case():
    assert Dialect.load("ASLUAV") is Dialect.load("asluav") is asluav.dialect
    assert Dialect.load("common.xml") is common.dialect
    with pytest.raises(UnknownDialectError, match=r"commun.*ardupilotmega"):
        Dialect.load("commun")
    with pytest.raises(KeyError):
        Dialect.load("../common")


def test_lookup_by_name_and_id():
    dialect = Dialect.load("ardupilotmega")
    assert dialect["ATTITUDE"] is dialect[30] is ardupilotmega.Attitude
    assert "ATTITUDE" in dialect
    assert 30 in dialect
    assert "MAV_CMD" not in dialect
    assert 30.5 not in dialect
    assert len(dialect) == len(list(dialect)) == len(dialect.names) == len(dialect.core_dialect)
    for wrong in ("ATTITUD", 9_999_999, "attitude"):
        with pytest.raises(UnknownMessageError, match=str(wrong)):
            dialect[wrong]
    with pytest.raises(KeyError):
        dialect["ATTITUD"]
    assert repr(dialect) == f"<Dialect ardupilotmega: {len(dialect)} messages>"


def test_properties_of_a_dialect():
    dialect = Dialect.load("ardupilotmega")
    assert (dialect.name, dialect.version, dialect.path) == ("ardupilotmega", 3, "")
    assert [item.name for item in dialect.with_includes][:3] == ["minimal", "standard", "common"]
    assert dialect.with_includes[-1] is dialect
    assert len(dialect.definition.messages) == len(dialect)
    assert len(dialect.definition.enums) == len(dialect.enums)
    assert len(dialect.own_definition.messages) < len(dialect)
    assert pickle.loads(pickle.dumps(dialect)) is dialect


@pytest.mark.parametrize("name", official_names())
def test_every_dialect_creates_all_its_classes(name):
    dialect = Dialect.load(name)
    for message_class in dialect:
        definition = message_class.definition
        assert issubclass(message_class, Message)
        assert dialect[definition.name] is dialect[definition.id] is message_class
        assert message_class.__match_args__ == tuple(item.name for item in definition.fields)


def test_a_class_belongs_to_the_file_that_defines_it():
    assert common.Heartbeat is minimal.Heartbeat is ardupilotmega.Heartbeat is all.Heartbeat
    assert common.Attitude.__module__ == "mavstack.dialects.common"
    assert pickle.loads(pickle.dumps(ardupilotmega.Attitude)) is common.Attitude


def test_a_larger_enum_creates_a_subclass():
    for smaller, larger in ((common, ardupilotmega), (ardupilotmega, storm32), (storm32, all), (asluav, all)):
        assert smaller.CommandLong is not larger.CommandLong
        assert issubclass(larger.CommandLong, smaller.CommandLong)
    match ardupilotmega.CommandLong(command=42000):
        case common.CommandLong(command=command):
            assert command is ardupilotmega.MavCmd(42000)
        case _:
            pytest.fail("no match")
    assert type(common.CommandLong(command=42000).command) is int
    assert not isinstance(common.CommandLong(), ardupilotmega.CommandLong)


def test_paparazzi_reuses_ids_of_ardupilotmega_and_both_load():
    assert Dialect.load("paparazzi")[180].__name__ == "ScriptItem"
    assert ardupilotmega.dialect[180].__name__ == "CameraFeedback"


@pytest.mark.parametrize("name", official_names())
def test_our_definition_files_load_as_custom_dialects(name):
    official = Dialect.load(name)
    loaded = Dialect.from_xml(DEFINITIONS / f"{name}.xml")
    assert compare(official.definition, loaded.definition, prose=True) == []
    for ours, theirs in zip(loaded.with_includes, official.with_includes, strict=True):
        assert list(ours.table.content()) == list(theirs.table.content())
    for message_class in loaded:
        assert issubclass(message_class, official[message_class.definition.id])


def test_an_unchanged_file_gives_the_same_dialect_again(tmp_path):
    path = tmp_path / "own.xml"
    message = '<message id="9" name="OWN"><field type="uint8_t" name="a"/></message>'
    text = f"<mavlink><messages>{message}</messages></mavlink>"
    path.write_text(text)
    first = Dialect.from_xml(path)
    assert Dialect.from_xml(str(path)) is first
    path.write_text(text.replace("uint8_t", "uint16_t"))
    second = Dialect.from_xml(path)
    assert second is not first
    assert (first["OWN"].definition.length, second["OWN"].definition.length) == (1, 2)


@pytest.fixture
def older(tmp_path):
    """Load another version of common: MISSION_ACK without extensions, STATUSTEXT with an additional field."""
    for path in DEFINITIONS.glob("*.xml"):
        shutil.copy(path, tmp_path)
    common_xml = tmp_path / "common.xml"
    text = common_xml.read_text()
    start = text.index('name="MISSION_ACK"')
    cut = text.index("<extensions/>", start), text.index("</message>", start)
    text = text[: cut[0]] + text[cut[1] :]
    text = text.replace(
        '<field type="uint8_t" name="chunk_seq"/>',
        '<field type="uint8_t" name="chunk_seq"/><field type="uint8_t" name="colour"/>',
    )
    common_xml.write_text(text)
    return Dialect.from_xml(common_xml)


def test_several_versions_coexist_and_match_the_official_classes(older):
    newer = Dialect.load("common")
    ack = older["MISSION_ACK"](type=3)
    assert ack.definition.length < newer["MISSION_ACK"].definition.length
    match ack:
        case common.MissionAck(type=kind, mission_type=mission):
            assert (kind, mission) == (3, 0)
        case _:
            pytest.fail("no match")
    assert "mission_type" not in ack.to_dict()
    text = older["STATUSTEXT"](text="x", colour=5)
    assert isinstance(text, common.Statustext)
    assert (text.text, text.colour) == ("x", 5)
    assert not hasattr(common.Statustext(), "colour")


def test_a_custom_message_with_another_layout_is_another_class(tmp_path):
    path = tmp_path / "own.xml"
    path.write_text(
        '<mavlink><messages><message id="30" name="ATTITUDE"><field type="float" name="roll"/></message>'
        "</messages></mavlink>"
    )
    assert not issubclass(Dialect.from_xml(path)["ATTITUDE"], common.Attitude)


def test_invalid_python_names_of_fields_get_an_underscore(tmp_path):
    path = tmp_path / "own.xml"
    names = ["class", "None", "definition", "to_dict", "__class__", "from_payload", "x", "class_"]
    fields = "".join(f'<field type="uint8_t" name="{name}"/>' for name in names)
    path.write_text(f'<mavlink><messages><message id="9" name="OWN">{fields}</message></messages></mavlink>')
    own = Dialect.from_xml(path)["OWN"]
    message = own(*range(1, 9))
    assert own.__match_args__[:4] == ("class_", "None_", "definition_", "to_dict_")
    assert message.class_ == 1
    assert message.to_dict() == dict(zip(names, range(1, 9), strict=True))
    assert own.from_dict(message.to_dict()) == message
    assert own.from_json(message.to_json()) == message
    assert own.definition.name == "OWN"
    assert pickle.loads(pickle.dumps(message)) == message


def test_descriptions_of_a_custom_file_are_kept(tmp_path):
    path = tmp_path / "own.xml"
    path.write_text(
        '<mavlink><messages><message id="9" name="OWN"><description>A message.</description>'
        '<field type="uint8_t" name="a">A field.</field></message></messages></mavlink>'
    )
    own = Dialect.from_xml(path)["OWN"]
    assert (own.__doc__, own.definition.fields[0].description) == ("A message.", "A field.")


DEFINITION = """<?xml version="1.0"?>
<mavlink><include>common.xml</include><messages>
  <message id="54321" name="TEXT_ONLY"><field type="uint8_t" name="level">Level.</field></message>
</messages></mavlink>"""


@pytest.mark.parametrize("text", [DEFINITION, DEFINITION.encode(), "\n" + DEFINITION.partition("\n")[2]])
def test_xml_is_taken_as_text_too(text, tmp_path):
    dialect = Dialect.from_xml(text)
    assert dialect[54321].__name__ == "TextOnly"
    assert dialect[0].__name__ == "Heartbeat"
    assert Dialect.from_xml(text) is dialect
    path = tmp_path / "some.xml"
    path.write_text(DEFINITION)
    assert Dialect.from_xml(path)[54321].__name__ == "TextOnly"


def test_malformed_text_names_the_line():
    with pytest.raises(DialectError, match=r"<text>:2"):
        Dialect.from_xml("<mavlink>\n<broken></mavlink>")
