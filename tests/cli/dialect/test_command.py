from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import Dialect

if TYPE_CHECKING:
    from pathlib import Path

MINE = """<?xml version="1.0"?>
<mavlink>
  <include>common.xml</include>
  <messages>
    <message id="30" name="ATTITUDE">
      <field type="uint8_t" name="roll"/>
    </message>
  </messages>
</mavlink>
"""


@pytest.fixture
def definition(tmp_path: Path) -> Path:
    path = tmp_path / "mine.xml"
    path.write_text(
        '<mavlink><include>minimal.xml</include><enums><enum name="MY_ENUM" bitmask="true">'
        '<entry value="1" name="MY_ENUM_ONE"/><entry value="2" name="MY_ENUM_TWO"/></enum></enums>'
        '<messages><message id="53001" name="MY_MESSAGE"><description>Of mine.</description>'
        '<field type="uint16_t" name="speed" units="cm/s" invalid="UINT16_MAX"/>'
        '<field type="uint8_t" name="flags" enum="MY_ENUM"/>'
        '<extensions/><field type="char[10]" name="name"/></message></messages></mavlink>'
    )
    return path


def test_list(mav):
    result = mav("dialect", "list")
    assert result.code == 0
    assert "ardupilotmega" in result.out
    listed = json.loads(mav("dialect", "list", "--json").out)
    common = next(item for item in listed if item["name"] == "common")
    assert common["messages"] == len(Dialect.load("common"))
    assert common["includes"] == ["standard"]


def test_zeros_are_shown_as_json(mav):
    heartbeat = json.loads(mav("dialect", "show", "common", "HEARTBEAT", "--json").out)
    assert heartbeat["id"] == 0
    assert 0 in [field["offset"] for field in heartbeat["fields"]]
    assert json.loads(mav("dialect", "show", "common", "MAV_TYPE_GENERIC", "--json").out)["value"] == 0
    yaw = json.loads(mav("dialect", "show", "common", "MAV_CMD_CONDITION_YAW", "--json").out)
    assert (yaw["params"][0]["minimum"], yaw["params"][0]["maximum"]) == (0, 360)


def test_show_a_dialect(mav):
    out = mav("dialect", "show", "common").out
    assert "ATTITUDE" in out
    assert "MAV_CMD" in out
    assert "ATTITUDE" in json.loads(mav("dialect", "show", "common", "--json").out)["message_names"]


@pytest.mark.parametrize("what", ["ATTITUDE", "attitude", "30"])
def test_show_a_message(mav, what):
    out = mav("dialect", "show", "common", what).out
    assert out.startswith("ATTITUDE (30), common\n")
    assert "CRC_EXTRA 39, payload 28 bytes\n" in out
    assert "rad/s" in out


def test_show_message_details(mav, definition):
    out = mav("dialect", "show", definition, "MY_MESSAGE").out
    assert "Of mine." in out
    assert "payload 3 bytes, 13 with extensions" in out
    assert "MY_ENUM" in out
    assert "unknown: UINT16_MAX" in out
    assert "extension" in out
    facts = json.loads(mav("dialect", "show", definition, "MY_MESSAGE", "--json").out)
    assert facts["id"] == 53001
    assert [field["name"] for field in facts["fields"]] == ["speed", "flags", "name"]
    assert "line" not in facts


def test_show_an_enum_and_an_entry(mav, definition):
    assert "0x2  MY_ENUM_TWO" in mav("dialect", "show", definition, "my_enum").out
    out = mav("dialect", "show", "common", "MAV_CMD_NAV_TAKEOFF").out
    assert "an entry of MAV_CMD" in out
    assert "Altitude" in out
    assert json.loads(mav("dialect", "show", "common", "MAV_CMD_NAV_TAKEOFF", "--json").out)["value"] == 22


def test_every_page_of_every_dialect(mav):
    from mavstack.cli.dialect.pages import entry_page, enum_page, message_page

    dialect = Dialect.load("all")
    for message in dialect:
        assert message_page(message.definition)
    for name in dialect.enums:
        enum = dialect.enum_definition(name)
        assert enum_page(enum)
        for entry in enum.entries:
            assert entry_page(entry, enum)


def test_unknown_names(mav):
    result = mav("dialect", "show", "common", "ATTITUD")
    assert (result.code, result.out) == (1, "")
    assert "did you mean ATTITUDE?" in result.err
    assert mav("dialect", "show", "common", "999999").code == 1
    assert mav("dialect", "show", "comon").code == 2


def test_check_a_valid_file(mav, definition):
    result = mav("dialect", "check", definition)
    assert result.code == 0
    assert "0 errors" in result.out


def test_check_an_invalid_file(mav, tmp_path):
    path = tmp_path / "bad.xml"
    path.write_text(MINE)
    result = mav("dialect", "check", path)
    assert result.code == 1
    assert f"{path}:5: error:" in result.out
    assert "1 errors" in result.err
    problems = json.loads(mav("dialect", "check", path, "--json").out)
    assert problems[0]["line"] == 5


def test_check_strictly(mav, tmp_path):
    path = tmp_path / "plain.xml"
    path.write_text(
        '<mavlink><messages><message id="1" name="A"><field type="char" name="a"/></message></messages>'
        "</mavlink>"
    )
    assert mav("dialect", "check", path).code == 0
    assert mav("dialect", "check", path, "--strict").code == 1


def test_check_against_an_older_version(mav, definition, tmp_path):
    old = tmp_path / "old.xml"
    old.write_text(
        definition.read_text().replace("<extensions/>", '<extensions/><field type="uint8_t" name="more"/>')
    )
    result = mav("dialect", "check", definition, "--against", old)
    assert result.code == 1
    assert "offset 1 -> 0 in the extensions (breaks the wire): peers with the older version" in result.out
    assert "note: removed field MY_MESSAGE.more" in result.out
    old.write_text(definition.read_text().replace('<entry value="2" name="MY_ENUM_TWO"/>', ""))
    result = mav("dialect", "check", definition, "--against", old, "--strict")
    assert result.code == 0
    assert "note: added entry MY_ENUM.MY_ENUM_TWO" in result.out
    assert result.out.endswith("0 errors, 0 warnings, 1 notes\n")
    old.write_text(definition.read_text().replace("uint16_t", "uint32_t").replace("UINT16", "UINT32"))
    result = mav("dialect", "check", definition, "--against", old)
    assert f"{definition}:1: error: changed message MY_MESSAGE: CRC_EXTRA " in result.out
    assert mav("dialect", "check", definition, "--against", tmp_path / "missing.xml").code == 2


def test_check_reserved_ids_and_words(mav, definition):
    definition.write_text(definition.read_text().replace("53001", "30").replace("flags", "class"))
    result = mav("dialect", "check", definition)
    assert result.code == 0
    assert "warning: message MY_MESSAGE has the id 30 of ATTITUDE of common" in result.out
    assert "note: MY_MESSAGE.class is a reserved word in " in result.out
    assert mav("dialect", "check", definition, "--strict").code == 1


def test_check_a_missing_file(mav, tmp_path):
    assert mav("dialect", "check", tmp_path / "missing.xml").code == 1


def test_diff(mav, definition, tmp_path):
    result = mav("dialect", "diff", "minimal", definition)
    assert result.code == 0
    assert "added message MY_MESSAGE" in result.out
    other = tmp_path / "other" / "mine.xml"
    other.parent.mkdir()
    other.write_text(definition.read_text().replace("uint16_t", "int32_t"))
    result = mav("dialect", "diff", definition, other, "--exit-code")
    assert result.code == 1
    assert "breaks the wire" in result.out
    changes = json.loads(mav("dialect", "diff", definition, other, "--json").out)
    assert any(change["breaks_wire"] for change in changes)
    assert "no differences" in mav("dialect", "diff", "common", "common").out


def test_import(mav, definition, tmp_path):
    target = tmp_path / "imported.xml"
    result = mav("dialect", "import", definition, "-o", target)
    assert result.code == 0
    assert "1 messages, 1 enums" in result.out
    assert "Of mine." not in target.read_text()
    assert mav("dialect", "diff", definition, target).out == "no differences\n"
    assert mav("dialect", "import", target, "-o", target).code == 2
    assert mav("dialect", "import", definition).code == 2


def test_stubs(mav, definition: Path, tmp_path: Path):
    folder = tmp_path / "package"
    assert mav("dialect", "stubs", str(definition), "-o", str(folder), "--check").code == 1
    assert not folder.exists()
    result = mav("dialect", "stubs", str(definition), "-o", str(folder))
    assert result.code == 0
    assert result.out.splitlines() == [str(folder / name) for name in ("mine.py", "mine.pyi", "mine.xml")]
    assert "class MyMessage(_Message):" in (folder / "mine.pyi").read_text("utf-8")
    assert mav("dialect", "stubs", str(definition), "-o", str(folder), "--check").code == 0
    (folder / "mine.pyi").write_text("old")
    outdated = mav("dialect", "stubs", str(definition), "-o", str(folder), "--check")
    assert (outdated.code, "out of date" in outdated.err, "mine.pyi" in outdated.err) == (1, True, True)
