"""Commands that look."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.shell.prompt_parts import prompt_parts
from mavstack.cli.shell.runner import run_line
from mavstack.cli.shell.session import Session
from mavstack.errors import HealthTimeout, MavstackError
from tests.cli.shell.shell_session import COPTER, PX4_COPTER, alone, in_shell, type_lines
from tests.vehicle.world import kind_name


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", [COPTER, PX4_COPTER], ids=kind_name)
def test_info_page(kind, capsys):
    type_lines("info", kind=kind)
    out = capsys.readouterr().out
    assert out.startswith(f"vehicle 1: quadrotor, {'PX4' if kind == PX4_COPTER else 'ArduPilot'} ")
    for word in ("disarmed, on the ground", "above sea", "battery", "3D fix", "ready to arm", "MAVLink 2"):
        assert word in " ".join(out.split())


@pytest.mark.nightly
def test_status_of_messages(capsys):
    type_lines("status HEARTBEAT; sleep 2; status GPS_R* SYS_STATUS")
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("HEARTBEAT type=QUADROTOR")
    assert {line.split()[0] for line in lines[1:]} == {"GPS_RAW_INT", "SYS_STATUS"}


@pytest.mark.nightly
def test_unknown_message():
    with pytest.raises(UsageError, match="there is no message NO_SUCH"):
        type_lines("status no_such")


@pytest.mark.nightly
def test_watch_ends_after_its_duration(capsys):
    type_lines("watch HEARTBEAT 3.5")
    assert 3 <= len(capsys.readouterr().out.splitlines()) <= 4


@pytest.mark.flight
def test_watch_without_duration_needs_an_interactive_shell():
    with pytest.raises(UsageError, match="number of seconds"):
        type_lines("watch HEARTBEAT")


@pytest.mark.nightly
def test_watch_requests_a_rate(capsys):
    type_lines("set rate 10; watch ATTITUDE 3")
    assert len(capsys.readouterr().out.splitlines()) > 20


@pytest.mark.nightly
def test_version_link_and_ping(capsys):
    type_lines("version; link; ping")
    out = capsys.readouterr().out
    for word in ("firmware", "memory://pair", " packets, 0 bytes", "4 of 4 pings answered"):
        assert word in out


@pytest.mark.flight
def test_health(capsys):
    async def scenario(session, world):
        await run_line(session, "health; ready 90; health")

    in_shell(COPTER, scenario, ready=False)
    out = capsys.readouterr().out
    assert out.startswith(("not ready to arm", "it does not say"))
    assert "\nready to arm" in out


def test_waiting_for_readiness_times_out():
    with pytest.raises(HealthTimeout):
        type_lines("ready 1", ready=False)


@pytest.mark.flight
def test_vehicles_are_listed_and_selected(capsys):
    async def scenario(session, world):
        await world.wait_until(lambda: len(session.connection.vehicles) == 2)
        await run_line(session, "vehicle; vehicle 2; vehicle; disarm")
        assert session.vehicle.system == 2
        with pytest.raises(MavstackError, match="no vehicle has the system id 9; known: 1, 2"):
            await run_line(session, "vehicle 9")

    in_shell([COPTER, PX4_COPTER], scenario)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("   1  quadrotor with ArduPilot"), "none is selected before the choice"
    assert lines[3].startswith("*  2  quadrotor with PX4")


@pytest.mark.parametrize(
    "line", ["info", "status", "health", "version", "ping", "arm", "param show", "rc", "nsh ls"]
)
def test_no_vehicle_is_an_error(line):
    with pytest.raises(MavstackError, match="no vehicle has been heard yet"):
        alone(lambda session: run_line(session, line))


def test_link_without_peers(capsys):
    alone(lambda session: run_line(session, "link; vehicle"))
    assert "no peer\nno vehicle has been heard yet\n" in capsys.readouterr().out


def test_several_vehicles_need_a_choice_before_any_command_acts(capsys):
    async def scenario(session, world):
        await session.connection.wait_for_vehicles(2)
        assert session.selected is None
        assert prompt_parts(session)[0] == ("silent", "vehicle 1, 2?")
        for line in ("arm", "param set RTL_ALT 3000", "loiter", "reboot", "info"):
            with pytest.raises(
                CommandError, match=r"more than one vehicle is heard \(1, 2\); `vehicle 1` selects"
            ):
                await run_line(session, line)
        await run_line(session, "vehicle 2")
        assert prompt_parts(session)[0] == ("system", "2")
        await run_line(session, "mode loiter")
        modes = [vehicle.mode for vehicle in session.connection.vehicles.values()]
        assert modes.count("LOITER") == 1
        assert session.connection.vehicles[2].mode == "LOITER"

    in_shell([COPTER, COPTER], scenario)


def test_the_only_vehicle_stays_selected_when_another_appears():
    async def scenario(session, world):
        first = session.vehicle
        session.connection = SimpleNamespace(vehicles={1: first, 2: object()})
        assert session.vehicle is first
        assert Session.selected.fget(SimpleNamespace(connection=session.connection, _system=None)) is None

    in_shell(COPTER, scenario)
