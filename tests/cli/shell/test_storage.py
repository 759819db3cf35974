"""Commands for stored data: the words of MAVProxy, and the options of `mav param` and others."""

from __future__ import annotations

import pytest

from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell.console_command import AlreadyReported
from mavstack.cli.shell.runner import run_line
from mavstack.errors import MavstackError
from tests.cli.shell.shell_session import COPTER, PX4_COPTER, alone, in_shell, type_lines
from tests.vehicle.world import kind_name

BOTH = [COPTER, PX4_COPTER]
WAYPOINTS = """\
QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t47.3977\t8.5456\t488\t1
1\t0\t3\t22\t0\t0\t0\t0\t47.3977\t8.5456\t20\t1
2\t0\t3\t16\t0\t0\t0\t0\t47.3980\t8.5460\t20\t1
3\t0\t2\t20\t0\t0\t0\t0\t0\t0\t0\t1
"""


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(("kind", "name"), [(COPTER, "RTL_ALT"), (PX4_COPTER, "RTL_RETURN_ALT")])
def test_parameters(kind, name, capsys, tmp_path):
    kept = tmp_path / "kept.params"

    async def scenario(session, world):
        await run_line(session, f"param set {name.lower()} 35; param show {name}; param fetch {name}")
        await run_line(session, f"param save {kept} {name}; param set {name} 30; param diff {kept}")
        await run_line(session, f"param load {kept}")
        assert world.simulated.parameters[name] == 35

    in_shell(kind, scenario)
    out = capsys.readouterr().out
    assert f"{name}: " in out
    assert "-> 35" in out
    assert "1 set" in out


@pytest.mark.flight
def test_param_fetch_counts_parameters(capsys):
    async def scenario(session, world):
        await run_line(session, "param fetch")
        assert len(session.vehicle.params.cached) > 100

    in_shell(COPTER, scenario)
    assert "parameters" in capsys.readouterr().out


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", BOTH, ids=kind_name)
def test_a_mission(kind, capsys, tmp_path):
    (given := tmp_path / "way.txt").write_text(WAYPOINTS)
    kept = tmp_path / "kept.waypoints"

    async def scenario(session, world):
        await run_line(session, f"wp load {given}; wp list; wp save {kept}; wp set 2; sleep 2; wp status")
        assert len(await session.vehicle.mission.download()) == (4 if kind == COPTER else 3)
        await run_line(session, "wp clear; mission show")

    in_shell(kind, scenario)
    out = capsys.readouterr().out
    assert "mission: 3 items uploaded" in out
    assert "item 2 of 3" in out
    assert "mission: cleared" in out
    assert kept.read_text().startswith("QGC WPL 110")


@pytest.mark.flight
def test_a_fence(capsys, tmp_path):
    fence = tmp_path / "area.fen"
    fence.write_text(
        "47.3977 8.5456\n47.3960 8.5440\n47.3990 8.5440\n47.3990 8.5470\n47.3960 8.5470\n47.3960 8.5440\n"
    )

    async def scenario(session, world):
        await run_line(session, f"fence load {fence}; fence list; fence enable; fence disable; fence clear")

    in_shell(COPTER, scenario)
    out = capsys.readouterr().out
    assert "stay inside the polygon of 4 vertices" in out
    assert out.count("fence enabled") == out.count("fence disabled") == 1


@pytest.mark.flight
def test_rally_points_are_listed(capsys):
    type_lines("rally list; rally clear")
    assert "rally points: cleared" in capsys.readouterr().out


@pytest.mark.flight
def test_files(capsys, tmp_path):
    (given := tmp_path / "patrol.lua").write_text("return 1\n")
    got = tmp_path / "got.lua"

    async def scenario(session, world):
        await run_line(session, "ftp mkdir /APM/mine; ftp list /APM")
        await run_line(session, f"ftp put {given} /APM/mine/; ftp get /APM/mine/patrol.lua {got}")
        await run_line(session, "ftp rename /APM/mine/patrol.lua /APM/mine/a.lua; ftp rm /APM/mine/a.lua")
        await run_line(session, "ftp rmdir /APM/mine")

    in_shell(COPTER, scenario)
    assert got.read_text() == "return 1\n"
    assert "mine/" in capsys.readouterr().out


@pytest.mark.flight
def test_logs(capsys, tmp_path):
    async def scenario(session, world):
        await run_line(session, "mode guided; arm throttle; sleep 3; disarm; sleep 3; log list")
        await run_line(session, f"log download latest {tmp_path / 'a.bin'}; log download all -o {tmp_path}")
        with pytest.raises(UsageError, match="--yes"):
            await run_line(session, "log erase")
        await run_line(session, "log erase --yes; log list")

    in_shell(COPTER, scenario)
    assert (tmp_path / "a.bin").stat().st_size == (tmp_path / "00000001.BIN").stat().st_size > 0
    assert "1 logs erased" in capsys.readouterr().out


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(("answer", "left"), [("y", 0), ("n", 1), ("", 1)])
def test_erasing_logs_asks_for_confirmation(answer, left):
    async def scenario(session, world):
        async def ask(question):
            assert "erase all logs of vehicle 1?" in question
            return answer

        session.ask = ask
        await run_line(session, "arm throttle; sleep 2; disarm; sleep 3")
        if left:
            with pytest.raises(MavstackError, match="no log was erased"):
                await run_line(session, "log erase")
        else:
            await run_line(session, "log erase")
        assert len(await session.vehicle.logs.list()) == left

    in_shell(COPTER, scenario)


@pytest.mark.parametrize(
    "line",
    [
        "param", "param guess", "param set", "param set A", "param set A B", "wp fly", "wp set", "wp set -1",
        "wp set two", "fence", "fence enable now", "rally what", "ftp", "ftp rmdir", "ftp guess", "log",
        "log show", "log download", "log download x", "mission", "mission upload", "ftp rm /",
        "param list --nonsense",
    ],
)  # fmt: skip
def test_wrong_usage(line):
    with pytest.raises((UsageError, MavstackError)) as caught:
        alone(lambda session: run_line(session, line))
    assert str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["param", "mission", "ftp", "log", "wp", "fence"])
def test_help_of_subcommands(name, capsys):
    alone(lambda session: run_line(session, f"{name} --help"))
    out = capsys.readouterr().out
    assert out.startswith("usage: ")
    assert "--url" not in out


@pytest.mark.flight
def test_partial_failure_is_reported_once(capsys):
    with pytest.raises(AlreadyReported):
        type_lines("param get RTL_ALT NO_SUCH_PARAM")
    captured = capsys.readouterr()
    assert "RTL_ALT" in captured.out
    assert "NO_SUCH_PARAM" in captured.err
