"""Shell lines of the documentation parse and run; XML, TOML, scripts and console commands are valid."""

from __future__ import annotations

import json
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
    "docker",
    "go",
    "ini",
    "java",
    "js",
    "json",
    "lua",
    "python",
    "rust",
    "sh",
    "sql",
    "svelte",
    "swift",
    "text",
    "toml",
    "ts",
    "xml",
    "yaml",
}
RECORDING = ROOT / "tests" / "recordings" / "flight.tlog"


def mav_lines(text: str) -> list[str]:
    """The lines that call `mav`."""
    return [line for line in text.splitlines() if line.startswith("mav ")]


def words_of(line: str) -> list[str]:
    """The words after `mav`, without comment, pipe and redirection."""
    words = shlex.split(line, comments=True)[1:]
    ends = [words.index(mark) for mark in ("|", ">", "<") if mark in words]
    return words[: min(ends, default=len(words))]


LINES = [
    (f"{block.name}", line)
    for block in BLOCKS
    if block.language == "sh" and not block.skipped
    for line in mav_lines(block.text)
]
TABLE_LINES = [("mavproxy", call) for row in comparison_rows("mavproxy.md") for call in row.ours]


SERVICES = [block for block in BLOCKS if "\nExecStart=" in block.text or block.language == "docker"]


def service_words(text: str) -> list[str]:
    """The program and the arguments that a unit of systemd or a container starts."""
    lines = text.splitlines()
    for line in (line for line in lines if line.startswith("ExecStart=")):
        return shlex.split(line.removeprefix("ExecStart="))
    (line,) = (line for line in lines if line.startswith(("ENTRYPOINT [", "CMD [")))
    return list(json.loads(line.partition(" ")[2]))


def test_every_block_has_a_known_language():
    assert {block.language for block in BLOCKS} <= KNOWN_LANGUAGES


@pytest.mark.parametrize(("place", "line"), [*LINES, *TABLE_LINES])
def test_commands_parse(place, line):
    name, *words = words_of(line)
    assert name in COMMANDS, place
    command_parser(name).parse_args(words)


@pytest.mark.skipif(shutil.which("node") is None, reason="Node is not installed")
@pytest.mark.parametrize(
    "block", [block for block in BLOCKS if block.language == "js"], ids=lambda block: block.name
)
def test_scripts_of_dashboards_run(block):
    if "bytes" in block.text:
        assert run_script(block.text, "script({}, state, 1, new Uint8Array([7]))") == {"rate": 7, "count": 1}
        return
    assert run_script(block.text, "(script({alt: 10}, state, 1), script({alt: 14}, state, 3))") == {"rate": 2}


def run_script(text: str, call: str) -> dict[str, float]:
    """The answer of a script of dashboards to a call."""
    script = f"new Function('values', 'state', 'time', 'bytes', {json.dumps(text)})"
    program = f"const state = {{}}; const script = {script}; console.log(JSON.stringify({call}))"
    done = subprocess.run(["node", "-e", program], capture_output=True, text=True, check=True, timeout=60)
    answer: dict[str, float] = json.loads(done.stdout)
    return answer


def test_the_decoder_of_the_guide_reads_its_frame(tmp_path, capsys):
    (block,) = (block for block in BLOCKS if block.directive == "decoder")
    (line,) = (line for _, line in LINES if line.startswith("mav data decode bench.json --hex"))
    (tmp_path / "bench.json").write_text(block.text, "utf-8")
    name, *words = words_of(line.replace("bench.json", str(tmp_path / "bench.json")))
    arguments = command_parser(name).parse_args(words)
    assert arguments.run_action(arguments) == 0
    assert capsys.readouterr().out.strip() == line.partition("# ")[2]


@pytest.mark.parametrize("block", SERVICES, ids=lambda block: block.name)
def test_commands_of_services_parse(block):
    program, name, *words = service_words(block.text)
    assert program.rpartition("/")[2] == "mav"
    command_parser(name).parse_args(words)


@pytest.mark.interop
@pytest.mark.parametrize(
    "block", [block for block in SERVICES if block.language == "ini"], ids=lambda block: block.name
)
def test_units_are_valid(block, tmp_path):
    if shutil.which("systemd-analyze") is None:
        pytest.skip("systemd-analyze is not installed")
    unit = tmp_path / "mavstack.service"
    unit.write_text(block.text.replace(service_words(block.text)[0], "/bin/true"), "utf-8")
    done = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", "--recursive-errors=no", str(unit)],
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")


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


@pytest.mark.parametrize(
    "block", [block for block in BLOCKS if block.language == "json"], ids=lambda block: block.name
)
def test_json_is_valid(block):
    assert json.loads(block.text)


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
