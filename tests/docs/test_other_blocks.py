"""Shell lines of the documentation parse and run; XML, TOML and console commands are valid."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tomllib
from typing import TYPE_CHECKING

import pytest

import mavstack
from mavstack.cli.registry import COMMANDS, command_parser
from mavstack.cli.shell.registry import COMMANDS as SHELL_COMMANDS
from mavstack.dialects import common
from mavstack.files.plans import PlanFile, write_plan
from mavstack.services.mission import MissionItem
from mavstack.sim import BackgroundSimulator
from tests.docs.blocks import BLOCKS, ROOT, comparison_rows

if TYPE_CHECKING:
    from pathlib import Path

KNOWN_LANGUAGES = {
    "c",
    "cpp",
    "csharp",
    "go",
    "java",
    "lua",
    "python",
    "rust",
    "sh",
    "sql",
    "swift",
    "text",
    "toml",
    "ts",
    "xml",
}
RECORDING = ROOT / "tests" / "recordings" / "flight.tlog"


def mav_lines(text: str) -> list[str]:
    """The lines that call `mav`."""
    return [line for line in text.splitlines() if line.startswith("mav ")]


def words_of(line: str) -> list[str]:
    """The words after `mav`, without comment, pipe and redirection."""
    words = shlex.split(line, comments=True)[1:]
    ends = [words.index(mark) for mark in ("|", ">") if mark in words]
    return words[: min(ends, default=len(words))]


LINES = [
    (f"{block.name}", line)
    for block in BLOCKS
    if block.language == "sh" and not block.skipped
    for line in mav_lines(block.text)
]
TABLE_LINES = [("mavproxy", call) for row in comparison_rows("mavproxy.md") for call in row.ours]


def test_every_block_has_a_known_language():
    assert {block.language for block in BLOCKS} <= KNOWN_LANGUAGES


@pytest.mark.parametrize(("place", "line"), [*LINES, *TABLE_LINES])
def test_commands_parse(place, line):
    name, *words = words_of(line)
    assert name in COMMANDS, place
    command_parser(name).parse_args(words)


@pytest.mark.parametrize(
    "block", [block for block in BLOCKS if block.language == "xml"], ids=lambda block: block.name
)
def test_definitions_load(block, tmp_path):
    path = tmp_path / "definition.xml"
    path.write_text(block.text, "utf-8")
    assert len(mavstack.Dialect.from_xml(path)) > len(mavstack.Dialect.load("common"))


@pytest.mark.parametrize(
    "block", [block for block in BLOCKS if block.language == "toml"], ids=lambda block: block.name
)
def test_settings_load(block):
    assert tomllib.loads(block.text)


def test_console_commands_exist():
    (block,) = (block for block in BLOCKS if block.directive == "shell commands")
    for line in block.text.splitlines():
        assert line.split()[0] in SHELL_COMMANDS, line


def mav(*words: str, url: str, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run `mav` in a folder, with a vehicle as default."""
    return subprocess.run(
        [sys.executable, "-m", "mavstack", *words],
        cwd=folder, env={**os.environ, "MAVSTACK_URL": url},
        capture_output=True, text=True, timeout=100, check=False, input="",
    )  # fmt: skip


@pytest.fixture
def vehicle_url():
    """One vehicle for all commands of a block; they leave and come back to it."""
    with BackgroundSimulator("copter", speed=5.0, link="udpin://127.0.0.1:0?idle=600") as vehicle:
        url = f"udpout://127.0.0.1:{vehicle.port}"
        mav("param", "set", "DISARM_DELAY", "0", url=url)  # a slow machine takes long between two commands
        yield url


@pytest.mark.interop
@pytest.mark.parametrize(
    "block", [block for block in BLOCKS if block.directive == "runnable"], ids=lambda block: block.name
)
def test_runnable_commands_run(block, vehicle_url, tmp_path):
    shutil.copy(RECORDING, tmp_path / "flight.tlog")
    items = [
        MissionItem(common.MavCmd.NAV_TAKEOFF, param7=10),
        MissionItem(common.MavCmd.NAV_RETURN_TO_LAUNCH),
    ]
    write_plan(tmp_path / "survey.plan", PlanFile.of(items))
    for line in mav_lines(block.text):
        done = mav(*words_of(line), url=vehicle_url, folder=tmp_path)
        assert done.returncode == 0, f"{line}\n{done.stderr}"
