"""Commands close to the wire."""

from __future__ import annotations

import pytest

from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell import raw
from mavstack.cli.shell.runner import run_line
from mavstack.dialects import ardupilotmega, common
from mavstack.errors import CommandDenied, InvalidArgumentError, MavstackError
from tests.cli.shell.shell_session import COPTER, PX4_COPTER, alone, in_shell, type_lines


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("name", ["COMPONENT_ARM_DISARM", "mav_cmd_component_arm_disarm", "400"])
def test_a_command_by_name_and_number(name):
    async def scenario(session, world):
        await run_line(session, f"long {name} 1")
        assert world.simulated.autopilot.armed

    in_shell(COPTER, scenario)


@pytest.mark.flight
def test_refused_command():
    with pytest.raises(CommandDenied, match="UNSUPPORTED"):
        type_lines("long 4242")


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("place", ["473980000 85460000", "47.3980 8.5460"])
def test_command_int_with_a_position(place):
    async def scenario(session, world):
        await run_line(session, f"command_int GLOBAL DO_SET_HOME 0 0 0 0 0 0 {place} 490")
        await run_line(session, "sleep 1")
        home = session.vehicle.home
        assert (home.latitude, home.longitude, home.altitude) == pytest.approx((47.398, 8.546, 490), abs=1e-6)

    in_shell(COPTER, scenario)


@pytest.mark.nightly
def test_channels_are_overridden_and_released(capsys):
    async def scenario(session, world):
        async with session.connection.packets() as _:
            await run_line(session, "rc 3 1500; rc 5 1200; rc; sleep 1")
            assert session.overrides.active(session.vehicle) == {3: 1500, 5: 1200}
            rc = session.vehicle.latest(common.RcChannels) or await session.vehicle.wait_for_message(
                common.RcChannels
            )
            assert rc.chan3_raw == 1500
            await run_line(session, "rc 5 0; rc clear; rc status")
            assert session.overrides.active(session.vehicle) == {}

    in_shell(COPTER, scenario)
    out = capsys.readouterr().out.splitlines()
    assert out[2] == "overridden: 3: 1500 µs, 5: 1200 µs"
    assert out[-1] == "overridden: none"


@pytest.mark.nightly
def test_leaving_releases_channels():
    async def scenario(session, world):
        await run_line(session, "rc all 1400; sleep 1")
        await session.overrides.close()
        assert session.overrides.active(session.vehicle) == {}

    in_shell(COPTER, scenario)


@pytest.mark.nightly
def test_nsh_line(capsys):
    type_lines("nsh ver all", "nsh param show SYS_AUTOSTART", kind=PX4_COPTER)
    out = capsys.readouterr().out
    assert "PX4" in out
    assert "SYS_AUTOSTART" in out
    assert "nsh>" not in out
    assert "ver all" not in out


@pytest.mark.nightly
def test_vehicle_without_a_shell():
    with pytest.raises(MavstackError, match="no shell answered"):
        type_lines("nsh ls")


@pytest.mark.parametrize(
    "line",
    [
        "long", "long NO_SUCH_CMD", "long 70000", "long 400 x", "long 400 1 2 3 4 5 6 7 8", "command_int",
        "command_int NOWHERE 400 0 0 0 0 0 0 0 0 0", "command_int 0 400 5 0 0 0 0 0 0 0 0", "nsh",
        "command_int 0 400 0 0 0 0 0 0 x 0 0",
    ],
)  # fmt: skip
def test_wrong_usage(line):
    with pytest.raises(UsageError):
        alone(lambda session: run_line(session, line))


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(
    "line", ["rc 3", "rc 0 1500", "rc 19 1500", "rc 3 70000", "rc three 1500", "rc 3 -1"]
)
def test_wrong_channels(line):
    with pytest.raises((UsageError, InvalidArgumentError)):
        type_lines(line)


def test_every_mav_cmd_can_be_named():
    for entry in ardupilotmega.MavCmd:
        assert raw.enum_value(ardupilotmega.MavCmd, "MAV_CMD_", f"MAV_CMD_{entry.name}", 0xFFFF) == entry
