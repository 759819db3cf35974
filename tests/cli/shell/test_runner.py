"""Lines and scripts run, whatever is in them."""

from __future__ import annotations

from contextlib import suppress

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell.registry import COMMANDS
from mavstack.cli.shell.runner import report_failure, run_line, run_lines
from mavstack.errors import MavstackError
from tests.cli.shell.shell_session import COPTER, alone, in_shell

#: Commands that read files and open links are left out: their errors depend on the machine.
SAFE = sorted(set(COMMANDS) - {"output", "sleep", "delay"})
VERBS = [
    "list",
    "set",
    "show",
    "load",
    "save",
    "get",
    "put",
    "clear",
    "add",
    "remove",
    "all",
    "download",
    "erase",
]
WORDS = st.one_of(
    st.sampled_from(
        [*VERBS, "1", "-1", "0", "1e9", "nan", "inf", "HEARTBEAT", "*", "--help", "--json", "force"]
    ),
    st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=12),
)
LINES = st.builds(
    lambda name, words: " ".join([name, *words]), st.sampled_from(SAFE), st.lists(WORDS, max_size=5)
)


async def each(*lines):
    for line in lines:
        yield line


@pytest.mark.flight
@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(lines=st.lists(st.one_of(LINES, st.text(max_size=30)), max_size=3))
def test_any_line_runs_or_fails_cleanly(lines, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    async def scenario(session):
        for line in lines:
            with suppress(MavstackError, OSError):
                await run_line(session, line)

    alone(scenario)


@pytest.mark.nightly
@settings(max_examples=3, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(lines=st.lists(LINES.filter(lambda line: "reboot" not in line), min_size=25, max_size=25))
def test_any_line_on_a_vehicle_runs_or_fails_cleanly(lines, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    async def scenario(session, world):
        session.settings.wait = False
        for line in lines:
            with suppress(MavstackError, OSError):
                await run_line(session, line)
            session.exiting = False

    in_shell(COPTER, scenario)


@pytest.mark.parametrize(
    ("line", "hint"),
    [("takeof 5", "did you mean takeoff?"), ("xyzzy", "try help"), ("guided2", "did you mean")],
)
def test_unknown_command_suggests_a_similar_one(line, hint):
    with pytest.raises(UsageError, match="there is no command") as printed:
        alone(lambda session: run_line(session, line))
    assert hint in str(printed.value)


def test_command_names_ignore_case():
    alone(lambda session: run_line(session, "SET timeout 5; Help"))


@pytest.mark.parametrize(("keep_going", "limit"), [(False, 1), (True, 3)])
def test_keep_going(keep_going, limit, capsys):
    async def scenario(session):
        lines = each("set timeout 1; bad; set timeout 2", "worse", "set timeout 3")
        assert not await run_lines(session, lines, "a.txt", keep_going=keep_going)
        assert session.settings.timeout == limit

    alone(scenario)
    printed = capsys.readouterr().err.splitlines()
    assert printed[0].startswith("a.txt:1: there is no command 'bad'")
    assert [line.split(":")[1] for line in printed] == (["1", "2"] if keep_going else ["1"])


def test_script_succeeds():
    async def scenario(session):
        assert await run_lines(session, each("", "# nothing", "set timeout 1"))

    alone(scenario)


def test_exit_ends_a_script():
    async def scenario(session):
        assert await run_lines(session, each("exit", "bad"))

    alone(scenario)


def test_a_failure_is_one_line(capsys):
    report_failure(MavstackError("two\nlines"), "here: ")
    report_failure(OSError(2, "No such file", "way.txt"))
    assert capsys.readouterr().err == "here: two lines\nway.txt: No such file\n"
