"""Every command's help shows examples, and they are what the command understands."""

from __future__ import annotations

import shlex
from importlib import import_module
from pathlib import Path

import pytest

from mavstack.cli.registry import COMMANDS

RECORDING = Path(__file__).parents[1] / "recordings" / "flight.tlog"
OFFICIAL = Path(import_module("mavstack.dialects").__file__).parent / "definitions" / "minimal.xml"
#: Where a vehicle would be; a recording takes its place.
LINKS = ("udpin://0.0.0.0:14550", "/dev/ttyACM0,57600", "tcp:127.0.0.1:5760")
NOWHERE = ("--out", "udpout://127.0.0.1:9")
#: Arguments that end an example that would run without end.
BRIEFLY = {"sim": ("--for", "1", "--speed", "max", *NOWHERE), "demo": ("--for", "2", "--once")}
#: These are run by tests of their own, against a simulated vehicle, or with files of their own.
WITH_VEHICLE = (
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
    return [shlex.split(line.partition(" | ")[0]) for line in lines if line.startswith(f"mav {name}")]


@pytest.mark.parametrize("name", COMMANDS)
def test_help_shows_examples(mav, name):
    result = mav(name, "--help")
    assert result.code == 0
    assert "examples:\n" in result.out
    assert f"  mav {name}" in result.out.partition("examples:\n")[2]
    assert examples_of(name)


def words_of(example: list[str]) -> list[str]:
    """The example without what it needs and a test has not."""
    words = [f"file://{RECORDING}?speed=max" if word in LINKS else word for word in example[1:]]
    words = [str(RECORDING) if word == "flight.tlog" else word for word in words]
    if "--each" in words:
        words[words.index("--out") + 1] = "udpout://127.0.0.1:9"
        return [*words, *BRIEFLY["sim"][:4]]
    if any(word.startswith("msp+") for word in words):
        words[words.index("--out") + 1] = "msp+udpout://127.0.0.1:9"
        return [*words, *BRIEFLY["sim"][:4]]
    if "--bootloader" in words:
        words[words.index("--out") + 1] = "udpout://127.0.0.1:9"
        return [*words, *BRIEFLY["sim"][:2]]
    return [*words, *BRIEFLY.get(words[0], ())]


#: An option of the live display; its tests render the display.
NEEDS_TERMINAL = "--trend"
EXAMPLES = [
    example
    for name in COMMANDS
    if name not in WITH_VEHICLE
    for example in examples_of(name)
    if NEEDS_TERMINAL not in example
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
