"""Commands of the shell from other packages."""

from __future__ import annotations

import sys
import tomllib
from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path

import pytest

from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell import Command
from mavstack.cli.shell.completion import complete
from mavstack.cli.shell.plugins import GROUP, with_plugins
from mavstack.cli.shell.registry import COMMANDS
from mavstack.cli.shell.runner import run_line
from mavstack.cli.shell.session import Session
from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.plugins import Registry
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect

EXAMPLE = Path(__file__).parents[3] / "examples" / "console_command"


async def nothing(session, words):
    pass


@pytest.fixture
def install(monkeypatch):
    """Install plug-ins: `name = module:attribute` of the example, or of this module."""
    monkeypatch.syspath_prepend(str(EXAMPLE))
    monkeypatch.delitem(sys.modules, "mavstack_say", raising=False)

    def install(**entries: str) -> tuple[dict[str, Command], list[str]]:
        found = EntryPoints(EntryPoint(name, value, GROUP) for name, value in entries.items())
        monkeypatch.setattr(Registry, "plugins", lambda registry: found.select(group=registry.group))
        problems: list[str] = []
        return with_plugins(COMMANDS, lambda error: problems.append(str(error))), problems

    return install


def example_entry() -> str:
    project = tomllib.loads((EXAMPLE / "pyproject.toml").read_text("utf-8"))["project"]
    return project["entry-points"][GROUP]["say"]


def test_the_example_is_a_command_of_the_shell(install, capsys):
    commands, problems = install(say=example_entry())
    assert problems == []
    assert set(commands) == {*COMMANDS, "say"}
    heard = []

    async def work() -> None:
        network = MemoryNetwork()
        async with (
            Node(network.link(), system=2) as other,
            connect(network.link()) as connection,
            Session(connection, commands) as session,
        ):
            other.add_listener(common.Statustext, lambda text: heard.append((text.severity, text.text)))
            await run_line(session, "say --severity warning battery swap; sleep 1; help say")
            with pytest.raises(UsageError, match="usage: say"):
                await run_line(session, "say")
            with pytest.raises(UsageError, match="is not a severity"):
                await run_line(session, "say --severity loud x")
            assert (await complete(session, "say --severity war"))[0] == ["warning"]

    run_virtually(work())
    assert heard == [(common.MavSeverity.WARNING, "battery swap")]
    assert "Send a status text to all components" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "value", "problem"),
    [
        ("lost", "no_such_module:COMMAND", "ModuleNotFoundError: No module named 'no_such_module'"),
        ("lost", "mavstack_say:NONE", "AttributeError"),
        ("lost", "mavstack_say:say", "is a function, not a Command"),
        ("other", "mavstack_say:COMMAND", "its command is named 'say', its entry point 'other'"),
        ("arm", f"{__name__}:TAKEN", "there is a command 'arm' already"),
    ],
)
def test_a_plugin_that_fails_is_reported_in_one_line(install, name, value, problem):
    commands, problems = install(**{name: value})
    assert commands == dict(COMMANDS)
    (reported,) = problems
    assert reported.startswith(f"plug-in {name} was left out: ")
    assert problem in reported
    assert "\n" not in reported


def test_one_that_fails_does_not_keep_others_out(install):
    commands, problems = install(say=example_entry(), broken="no_such_module:X")
    assert "say" in commands
    assert len(problems) == 1


def test_the_shell_starts_without_a_broken_plugin(mav, simulate, install):
    simulate(ready=False)
    install(broken="no_such_module:X")
    result = mav("shell", "--command", "vehicle")
    assert result.code == 0
    reported = [line for line in result.err.splitlines() if "plug-in" in line]
    assert reported == ["plug-in broken was left out: ModuleNotFoundError: No module named 'no_such_module'"]


TAKEN = Command("arm", "", "a name that is taken", nothing)
