"""The shell drives outputs and payload, and asks before dangerous actions."""

from __future__ import annotations

import pytest

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.shell.runner import run_line
from tests.cli.shell.shell_session import COPTER, in_shell


def test_outputs(capsys):
    async def scenario(session, world):
        payload = world.simulated.autopilot.payload
        await run_line(session, "servo set 9 1900; relay 0 on; ekfsource 1")
        assert (payload.servos[9], payload.relays[0]) == (1900, True)
        await run_line(session, "roi 47.3985 8.5460")
        assert payload.region_of_interest is not None
        await run_line(session, "roi none")
        assert payload.region_of_interest is None
        with pytest.raises(UsageError, match="required: VALUE"):
            await run_line(session, "actuator 1")

    in_shell(COPTER, scenario)
    assert "servo 9 at 1900 µs" in capsys.readouterr().out


def test_termination_asks():
    async def scenario(session, world):
        await run_line(session, "arm")
        with pytest.raises(UsageError, match="add --yes"):
            await run_line(session, "terminate")
        asked = []

        async def ask(question):
            asked.append(question)
            return "n"

        session.ask = ask
        with pytest.raises(CommandError, match="nothing was sent"):
            await run_line(session, "terminate")
        assert asked == ["stop the motors of vehicle 1 permanently? [y/N] "]
        assert world.simulated.autopilot.armed
        await run_line(session, "terminate --yes")
        assert not world.simulated.autopilot.armed

    in_shell(COPTER, scenario)
