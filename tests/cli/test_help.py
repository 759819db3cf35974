"""Every command's help shows examples, and they are what the command understands."""

from __future__ import annotations

import shlex
from importlib import import_module
from pathlib import Path

import pytest

from mavstack.cli.registry import COMMANDS, command_parser

RECORDING = Path(__file__).parents[1] / "recordings" / "flight.tlog"
OFFICIAL = Path(import_module("mavstack.dialects").__file__).parent / "definitions" / "minimal.xml"
RECORDINGS = ("flight.tlog", "fleet.tlog")
#: Where a vehicle would be; a recording takes its place.
LINKS = ("udpin://0.0.0.0:14550", "/dev/ttyACM0,57600", "tcp:127.0.0.1:5760")
NOWHERE = ("--out", "udpout://127.0.0.1:9")
#: Arguments that end an example that would run without end.
BRIEFLY = {"sim": ("--for", "1", "--speed", "max", *NOWHERE), "demo": ("--for", "2", "--once")}
#: These are run by tests of their own: they serve without end, or need a simulated vehicle or files.
WITH_VEHICLE = (
    "web",
    "simulator",
    "record",
    "route",
    "data",
    "vehicle",
    "swarm",
    "rate",
    "param",
    "mission",
    "ftp",
    "log",
    "camera",
    "gimbal",
    "rtk",
    "traffic",
    "relay",
    "rid",
    "serial",
    "terrain",
    "map",
    "bridge",
    "external",
    "key",
    "msp",
    "radio",
    "firmware",
    "shell",
    "gen",
)


def examples_of(name: str) -> list[list[str]]:
    text = import_module(COMMANDS[name].module).EXAMPLES.split("\n\n", maxsplit=1)[0]
    lines = [line.strip().split("   ")[0] for line in text.splitlines()]
    commands = [line.partition(" | ")[0] for line in lines if line.startswith(f"mav {name}")]
    return [shlex.split(each, comments=True) for each in commands]


@pytest.mark.parametrize("name", COMMANDS)
def test_help_shows_examples(mav, name):
    result = mav(name, "--help")
    assert result.code == 0
    assert "examples:\n" in result.out
    assert f"  mav {name}" in result.out.partition("examples:\n")[2]
    assert examples_of(name)


@pytest.mark.parametrize("name", COMMANDS)
def test_the_command_understands_its_examples(name):
    parser = command_parser(name)
    parse = parser.parse_intermixed_args if COMMANDS[name].mixed else parser.parse_args
    for example in examples_of(name):
        end = min((example.index(each) for each in "<>;" if each in example), default=None)
        assert parse(example[2:end])  # what it does not understand ends the program


def words_of(example: list[str]) -> list[str]:
    """The example without what it needs and a test has not."""
    words = [f"file://{RECORDING}?speed=max" if word in LINKS else word for word in example[1:]]
    words = [str(RECORDING) if word in RECORDINGS else word for word in words]
    if "--each" in words:
        words[words.index("--out") + 1] = "udpout://127.0.0.1:9"
        return [*words, *BRIEFLY["sim"][:4]]
    if any(word.startswith("msp+") for word in words):
        words[words.index("--out") + 1] = "msp+udpout://127.0.0.1:9"
        return [*words, *BRIEFLY["sim"][:4]]
    if "--bootloader" in words:
        words[words.index("--out") + 1] = "udpout://127.0.0.1:9"
        return [*words, *BRIEFLY["sim"][:2]]
    if "--to" in words:
        words += ["--speed", "100"]
    return [*words, *BRIEFLY.get(words[0], ())]


#: Options of the live display; its tests render the display.
NEED_TERMINAL = {"--trend", "--tui"}
EXAMPLES = [
    example
    for name in COMMANDS
    if name not in WITH_VEHICLE
    for example in examples_of(name)
    if NEED_TERMINAL.isdisjoint(example)
]


@pytest.mark.flight_cases(8)
@pytest.mark.fast_cases(11)
@pytest.mark.parametrize("example", EXAMPLES, ids=" ".join)
def test_examples_of_the_help_run(mav, monkeypatch, tmp_path, example):
    monkeypatch.chdir(tmp_path)
    own, official = tmp_path / "mine.xml", tmp_path / "official.xml"
    for path in (own, official, tmp_path / "old.xml"):
        path.write_text(OFFICIAL.read_text("utf-8"), "utf-8")
    if "import" in example:
        own.unlink()
    if "--check" in example:
        assert mav(*words_of([word for word in example if word != "--check"])).code == 0
    command = example[: example.index(">")] if ">" in example else example  # the shell redirects
    result = mav(*words_of(command))
    assert result.code == 0, result.err
    assert own.is_file()
    assert result.out or "import" in example or "--check" in example
