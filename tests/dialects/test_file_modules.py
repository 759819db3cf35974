"""Modules of a user's dialect: typed for type checkers, and equal to the dialect at run time."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest

import mavstack
from mavstack.dialects import Dialect, common
from mavstack.dialects.file_modules import outdated_files, write_dialect_module
from mavstack.errors import DialectError
from tests.type_checkers import run_mypy

OTHER = """<mavlink><enums><enum name="NOZZLE"><entry value="1" name="NOZZLE_FLAT"/></enum></enums>
<messages><message id="42001" name="TANK"><field type="float" name="level"/></message></messages></mavlink>"""
MINE = """<mavlink><include>common.xml</include><include>parts/other.xml</include>
<enums>
  <enum name="MAV_CMD"><entry value="31900" name="MAV_CMD_SPRAY"/></enum>
  <enum name="SPRAY_FLAGS" bitmask="true"><entry value="1" name="SPRAY_FLAGS_ON"/></enum>
</enums>
<messages>
  <message id="42000" name="SPRAY_STATUS"><description>State of the "sprayer" \\ pump.</description>
    <field type="float" name="rate"/><field type="uint8_t" name="flags" enum="SPRAY_FLAGS"/>
    <field type="uint8_t" name="nozzle" enum="NOZZLE"/><field type="uint16_t[3]" name="cells"/>
    <field type="char[10]" name="label"/>
  </message>
  <message id="42002" name="ODD"><field type="uint8_t" name="int"/><field type="float" name="float"/>
    <field type="uint8_t" name="class"/></message>
</messages></mavlink>"""

RIGHT = """
from typing import assert_type
import mavstack
import my_sprayer
from mavstack.dialects import common
from my_sprayer import MavCmd, Nozzle, Odd, SprayFlags, SprayStatus, Tank

status = SprayStatus(rate=1.5, nozzle=Nozzle.FLAT, flags=SprayFlags.ON, cells=[1, 2, 3], label="left")
assert_type(status.rate, float)
assert_type(status.nozzle, Nozzle | int)
assert_type(status.flags, SprayFlags)
assert_type(status.cells, tuple[int, ...])
assert_type(status.label, str)
assert_type(Tank().level, float)
assert_type(Odd(int=1, float=2).int, int)
command: common.CommandLong = my_sprayer.CommandLong(command=MavCmd.SPRAY)
print(mavstack.Parser(my_sprayer), mavstack.connect("udpin://127.0.0.1:0", dialect=my_sprayer))
print(my_sprayer.Attitude().roll, my_sprayer.dialect.names, command)
"""
WRONG = ["my_sprayer.SprayStatus(rat=1)", "my_sprayer.SprayStatus().rat", "my_sprayer.MavCmd.SPRA"]


@pytest.fixture
def definition(tmp_path: Path) -> Path:
    (tmp_path / "xml" / "parts").mkdir(parents=True)
    (tmp_path / "xml" / "parts" / "other.xml").write_text(OTHER)
    path = tmp_path / "xml" / "my-sprayer.xml"
    path.write_text(MINE)
    return path


@pytest.mark.nightly
def test_a_type_checker_knows_the_messages_of_a_users_dialect(definition, tmp_path):
    folder = tmp_path / "package"
    write_dialect_module(definition, folder)
    (folder / "right.py").write_text(RIGHT)
    for index, text in enumerate(WRONG):
        (folder / f"wrong{index}.py").write_text(f"import my_sprayer\n{text}\n")
    checked = run_mypy("--config-file=", "--cache-dir", str(tmp_path / "cache"), str(folder))
    output, errors = checked.stdout, checked.stderr
    lines = [line for line in output.splitlines() if ": error: " in line]
    assert errors == ""
    assert sorted({Path(line.split(":")[0]).name for line in lines}) == [
        f"wrong{index}.py" for index in range(len(WRONG))
    ], output


def test_the_module_is_the_dialect_at_run_time(definition, tmp_path, monkeypatch):
    written = write_dialect_module(definition, tmp_path / "package")
    names = ["my_sprayer.py", "my_sprayer.pyi", "my-sprayer.xml", "other.xml"]
    assert sorted(path.name for path in written) == sorted(names)
    definition.unlink()  # the module needs its own copy only
    monkeypatch.syspath_prepend(str(tmp_path / "package"))
    module = importlib.import_module("my_sprayer")
    try:
        assert isinstance(module.dialect, Dialect)
        status = module.SprayStatus(rate=1.5, nozzle=module.Nozzle.FLAT)
        packet = mavstack.encode(status, system=1, component=1, sequence=0)
        assert mavstack.Parser(module).feed(packet)[0].message == status
        assert isinstance(module.CommandLong(command=module.MavCmd.SPRAY), common.CommandLong)
        assert module.Attitude is common.Attitude
        assert "SprayStatus" in dir(module)
        with pytest.raises(AttributeError, match="dialect my-sprayer has no message or enum class 'Nothing'"):
            module.Nothing  # noqa: B018
    finally:
        sys.modules.pop("my_sprayer", None)


def test_outdated_files_are_found_and_written(definition, tmp_path):
    folder = tmp_path / "package"
    written = write_dialect_module(definition, folder)
    assert outdated_files(definition, folder) == []
    definition.write_text(MINE.replace('name="rate"', 'name="amount"'))
    assert {path.name for path in outdated_files(definition, folder)} == {"my-sprayer.xml", "my_sprayer.pyi"}
    assert write_dialect_module(definition, folder) == written
    assert outdated_files(definition, folder) == []
    assert "amount: float" in (folder / "my_sprayer.pyi").read_text("utf-8")


def test_the_module_may_be_beside_the_definition(definition):
    write_dialect_module(definition, definition.parent)
    assert definition.read_text() == MINE
    assert outdated_files(definition, definition.parent) == []


def test_a_definition_that_is_not_valid_or_elsewhere_raises(definition, tmp_path):
    (tmp_path / "far.xml").write_text(OTHER)
    definition.write_text(MINE.replace("parts/other.xml", "../far.xml"))
    with pytest.raises(DialectError, match="outside the folder of the dialect; copy it beside the dialect"):
        write_dialect_module(definition, tmp_path / "package")
    assert not (tmp_path / "package").exists()
    with pytest.raises(DialectError, match="no such file"):
        write_dialect_module(tmp_path / "missing.xml", tmp_path)
