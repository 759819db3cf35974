"""Commands for the shell itself."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell.console_command import AlreadyReported
from mavstack.cli.shell.registry import COMMANDS
from mavstack.cli.shell.runner import run_line
from mavstack.dialects import common
from mavstack.errors import LinkError, MavstackError
from mavstack.links import BytesReceived
from tests.cli.shell.shell_session import COPTER, alone, in_shell

UNIQUE = list(dict.fromkeys(COMMANDS.values()))


def test_help_lists_every_command(capsys):
    alone(lambda session: run_line(session, "help"))
    listed = {line.split()[0] for line in capsys.readouterr().out.splitlines() if line.startswith("  ")}
    assert listed == {command.name for command in UNIQUE}


@pytest.mark.parametrize("command", UNIQUE, ids=lambda command: command.name)
def test_help_of_each_command(command, capsys):
    alone(lambda session: run_line(session, f"help {command.name}"))
    out = capsys.readouterr().out
    assert out.startswith(command.synopsis + "\n")
    for example in command.examples:
        assert example in out
        assert example.split()[0] in COMMANDS


def test_settings(capsys):
    async def scenario(session):
        await run_line(session, "set wait off; set timeout 12.5; set severity warning; set; set wait")
        assert session.settings.wait is False
        assert session.settings.timeout == 12.5
        assert session.settings.severity == common.MavSeverity.WARNING

    alone(scenario)
    lines = capsys.readouterr().out.split("\n")
    assert lines[0].split() == ["wait", "off"]
    assert lines[4].split() == ["wait", "off"]


@pytest.mark.parametrize(
    "line",
    ["set colour", "set wait perhaps", "set timeout -1", "set timeout nan", "set severity loud", "set a b c"],
)
def test_wrong_settings(line):
    with pytest.raises(UsageError):
        alone(lambda session: run_line(session, line))


def test_aliases(capsys):
    async def scenario(session):
        await run_line(session, 'alias add calm "set wait off; set timeout 5"; calm; alias; alias list')
        assert session.settings.timeout == 5
        await run_line(session, "alias add wait_time set timeout; wait_time 7")
        assert session.settings.timeout == 7
        await run_line(session, "help calm; alias remove calm")
        with pytest.raises(UsageError, match="there is no command 'calm'"):
            await run_line(session, "calm")

    alone(scenario)
    assert "calm is an alias of: set wait off; set timeout 5" in capsys.readouterr().out


@pytest.mark.parametrize(
    "line",
    [
        "alias add",
        "alias add x",
        "alias add 'a b' help",
        "alias add alias help",
        "alias remove x",
        "alias what",
    ],
)
def test_wrong_aliases(line):
    with pytest.raises(UsageError):
        alone(lambda session: run_line(session, line))


def test_recursive_alias_fails():
    with pytest.raises(UsageError, match="calls itself"):
        alone(lambda session: run_line(session, "alias add a b; alias add b a; a"))


def test_script_runs_until_a_failure(tmp_path, capsys):
    script = tmp_path / "a.txt"
    script.write_text("# settings\nset timeout 3\n\nset timeout x; set timeout 4\nset timeout 5\n")

    async def scenario(session):
        with pytest.raises(AlreadyReported):
            await run_line(session, f"script {script}")
        assert session.settings.timeout == 3

    alone(scenario)
    assert f"{script}:4: timeout must be a number of 0 or more, not 'x'\n" in capsys.readouterr().err


def test_recursive_script_fails(tmp_path, capsys):
    (script := tmp_path / "a.txt").write_text(f"script {tmp_path / 'a.txt'}")
    with pytest.raises(AlreadyReported):
        alone(lambda session: run_line(session, f"script {script}"))
    assert capsys.readouterr().err.count("runs itself") == 1


def test_unreadable_scripts(tmp_path):
    (tmp_path / "noise").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(OSError, match="No such file"):
        alone(lambda session: run_line(session, f"script {tmp_path / 'none'}"))
    with pytest.raises(MavstackError, match="not a text file"):
        alone(lambda session: run_line(session, f"script {tmp_path / 'noise'}"))


def test_exit_ends_the_line():
    async def scenario(session):
        await run_line(session, "exit; set timeout 5")
        assert session.exiting
        assert session.settings.timeout == 0

    alone(scenario)


@pytest.mark.nightly
def test_outputs_are_added_listed_and_removed(capsys):
    async def scenario(session, world):
        network = world.network.__class__()
        station = await network.link().open()
        await session.forwarding.add(network.link())
        await asyncio.sleep(3)
        events = [await anext(station) for _ in range(20)]
        output = b"".join(bytes(event.data) for event in events if isinstance(event, BytesReceived))
        assert output.startswith(b"\xfd")
        await run_line(session, "output; output remove 0; output list")
        with pytest.raises(MavstackError, match="not an output; outputs: none"):
            await run_line(session, "output remove 0")
        with pytest.raises(LinkError):
            await run_line(session, "output add nonsense://x")
        with pytest.raises(UsageError, match="usage"):
            await run_line(session, "output what")
        await station.close()

    in_shell(COPTER, scenario)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("0  memory://pair  1 peers")
    assert lines[1] == "there are no outputs"


@pytest.mark.parametrize(
    "line", ["sleep", "sleep -1", "sleep x", "exit now", "help a b", "help nothing", "script"]
)
def test_wrong_words(line):
    with pytest.raises(UsageError):
        alone(lambda session: run_line(session, line))
