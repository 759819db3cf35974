"""The shell arms and flies both firmwares."""

from __future__ import annotations

import pytest

from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell.runner import run_line
from mavstack.errors import ActionTimeout, CommandDenied, LocalProtocolError, MavstackError
from tests.cli.shell.shell_session import COPTER, PX4_COPTER, alone, in_shell, type_lines
from tests.vehicle.world import kind_name

BOTH = [COPTER, PX4_COPTER]


def height(world):
    return -world.simulated.body.truth.down


@pytest.mark.nightly
@pytest.mark.parametrize("kind", BOTH, ids=kind_name)
def test_a_flight(kind, capsys):
    async def scenario(session, world):
        await run_line(session, "arm throttle")
        assert world.simulated.autopilot.armed
        await run_line(session, "takeoff 12")
        assert height(world) == pytest.approx(12, abs=1.5)
        north, east = world.simulated.body.frame.to_global(25.0, 10.0, 0.0)[:2]
        await run_line(session, f"guided {north} {east} 15")
        truth = world.simulated.body.truth
        assert (truth.north, truth.east) == pytest.approx((25, 10), abs=3)
        await run_line(session, "setyaw 90; setspeed 5")
        assert session.vehicle.position.heading == pytest.approx(90, abs=6)
        await run_line(session, "hold; rtl")
        assert not world.simulated.autopilot.armed

    in_shell(kind, scenario)
    assert "armed\n" in capsys.readouterr().out


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", BOTH, ids=kind_name)
def test_mode_names_are_commands(kind, capsys):
    name = "POSCTL" if kind == PX4_COPTER else "ALT_HOLD"

    async def scenario(session, world):
        await run_line(session, f"mode {name.lower()}")
        assert session.vehicle.mode.lower() == name.lower()
        await run_line(session, "manual" if kind == PX4_COPTER else "stabilize")
        await run_line(session, "modes")

    in_shell(kind, scenario)
    assert name.lower() in capsys.readouterr().out.lower()


@pytest.mark.flight
def test_without_wait_commands_return_immediately():
    async def scenario(session, world):
        await run_line(session, "set wait off; mode guided; arm; takeoff 30")
        assert height(world) < 5

    in_shell(COPTER, scenario)


@pytest.mark.flight
def test_timeout_setting():
    with pytest.raises(ActionTimeout, match="not done in 2 s"):
        type_lines("set timeout 2; mode guided; arm throttle; takeoff 80")


def test_refusal_has_a_reason():
    with pytest.raises(CommandDenied, match="Arm"):
        type_lines("arm throttle", ready=False)


def test_force_arms_a_vehicle_that_is_not_ready():
    async def scenario(session, world):
        await run_line(session, "arm throttle force")
        assert world.simulated.autopilot.armed
        await run_line(session, "disarm force")
        assert not world.simulated.autopilot.armed

    in_shell(COPTER, scenario, ready=False)


@pytest.mark.flight
def test_home_is_shown_and_set(capsys):
    async def scenario(session, world):
        await run_line(session, "home; home set; home 47.3978 8.5457 490; home")

    in_shell(COPTER, scenario)
    assert capsys.readouterr().out.splitlines()[-1] == "home: 47.3978000 8.5457000, 490.0 m above sea"


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", BOTH, ids=kind_name)
def test_reboot(kind):
    async def scenario(session, world):
        await run_line(session, "reboot")
        await run_line(session, "status HEARTBEAT")

    in_shell(kind, scenario)


@pytest.mark.flight
def test_relative_yaw():
    async def scenario(session, world):
        await run_line(session, "mode guided; arm; takeoff 10; setyaw 90; setyaw 30 20 1; sleep 5")
        assert session.vehicle.position.heading == pytest.approx(120, abs=6)

    in_shell(COPTER, scenario)


@pytest.mark.parametrize(
    "line",
    [
        "arm off", "disarm now", "takeoff high", "takeoff 1 2", "takeoff nan", "land 3", "guided 1",
        "guided a b", "orbit 1", "setspeed", "setspeed fast", "setyaw", "home 1", "home here now",
        "reboot twice", "hold on", "rtl 1",
    ],
)  # fmt: skip
def test_wrong_usage(line):
    with pytest.raises(UsageError, match=r"usage|is not a number"):
        alone(lambda session: run_line(session, line))


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("line", ["takeoff -3", "guided 91 0", "mode 99999999999999999999", "mode gu"])
def test_invalid_values(line):
    with pytest.raises((LocalProtocolError, MavstackError)) as caught:
        type_lines(line)
    assert "\n" not in str(caught.value)
