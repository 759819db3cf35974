"""Generated files are up to date, and stubs match the classes at run time."""

import ast
from pathlib import Path

import pytest

import mavstack.dialects
from mavstack.dialects import Dialect, generate
from mavstack.dialects.tables import official_names
from tests.type_checkers import run_mypy

HERE = Path(mavstack.dialects.__file__).parent


def test_generated_files_are_up_to_date():
    assert generate.out_of_date() == []
    assert generate.main(["--check"]) == 0
    assert generate.main(["--chek"]) == 2


def test_a_table_has_one_line_per_message_and_enum():
    for name in official_names():
        definition = Dialect.load(name).own_definition
        lines = (HERE / "tables" / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()
        assert len(lines) == 1 + len(definition.messages) + len(definition.enums)


@pytest.mark.parametrize("name", official_names())
def test_a_stub_declares_every_class_with_its_fields_and_members(name):
    dialect = Dialect.load(name)
    tree = ast.parse((HERE / f"{name.lower()}.pyi").read_text(encoding="utf-8"))
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    imported = {
        alias.asname
        for node in tree.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.asname
    }
    expected = dialect.messages_by_class.keys() | dialect.enums_by_class.keys()
    assert classes.keys() | {name for name in imported if not name.startswith("_")} == expected
    for message_class in dialect:
        if message_class.__module__.endswith(f".{name.lower()}"):
            body = classes[message_class.__name__].body
            fields = [node.target.id for node in body if isinstance(node, ast.AnnAssign)]
            assert tuple(fields) == message_class.__match_args__
    for enum in dialect.enums.values():
        if enum.__module__.endswith(f".{name.lower()}"):
            members = {
                node.targets[0].id for node in classes[enum.__name__].body if isinstance(node, ast.Assign)
            }
            assert members == set(enum.__members__)


PROGRAM = """
from typing import assert_type
from mavstack.dialects import Dialect, all, ardupilotmega, asluav, common

attitude = common.Attitude(1, roll=0.1)
assert_type(attitude.roll, float)
assert_type(ardupilotmega.Attitude().time_boot_ms, int)
heartbeat = common.Heartbeat(type=common.MavType.QUADROTOR, base_mode=81)
assert_type(heartbeat.base_mode, common.MavModeFlag)
heartbeat.base_mode = 3
assert_type(common.Statustext(text="x").text, str)
assert_type(common.FileTransferProtocol(payload=[1]).payload, bytes)
assert_type(common.AttitudeTarget(q=[1, 0, 0, 0]).q, tuple[float, ...])
assert_type(all.CommandLong(command=3).definition.crc_extra, int)
command: common.CommandLong = ardupilotmega.CommandLong()
match attitude:
    case ardupilotmega.Attitude(roll=roll):
        assert_type(roll, float)
dialects = [common.dialect, Dialect.load("common")]
print(asluav.core_dialect, attitude.replace(roll=1).to_json(), common.MavCmd.NAV_TAKEOFF.official_name)
"""

WRONG = [
    "from mavstack.dialects import common\ncommon.Attitude(rol=0.1)\n",
    'from mavstack.dialects import common\ncommon.Attitude(roll="a")\n',
    "from mavstack.dialects import common\ncommon.Attitude().rol\n",
    "from mavstack.dialects import common\ncommon.Atitude\n",
    "from mavstack.dialects import common\ncommon.MavCmd.NAV_TAKEOF\n",
]


@pytest.mark.flight
def test_type_checkers_accept_valid_and_refuse_invalid_use(tmp_path):
    (tmp_path / "right.py").write_text(PROGRAM)
    for index, text in enumerate(WRONG):
        (tmp_path / f"wrong{index}.py").write_text(text)
    # "--config-file=" prevents mypy from reading the configuration of the project.
    checked = run_mypy("--config-file=", "--cache-dir", str(tmp_path / "cache"), str(tmp_path))
    output, errors = checked.stdout, checked.stderr
    lines = [line for line in output.splitlines() if ": error: " in line]
    assert errors == ""
    assert sorted({Path(line.split(":")[0]).name for line in lines}) == [
        f"wrong{index}.py" for index in range(len(WRONG))
    ]
