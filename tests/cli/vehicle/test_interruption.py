"""Ctrl-C ends a command, not the action of the vehicle: the command says so."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.cli.shell.runner import run_line
from mavstack.cli.vehicle.interruption import notice_of_interruption
from tests.cli.shell.shell_session import COPTER, in_shell


def test_cancelled_takeoff_in_the_shell(capsys):
    async def scenario(session, world):
        await run_line(session, "mode guided; arm")
        task = asyncio.create_task(run_line(session, "takeoff 30"))
        await asyncio.sleep(4)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)

    in_shell(COPTER, scenario)
    err = capsys.readouterr().err
    assert "interrupted: vehicle 1 goes on with takeoff (" in err
    assert "m high); `hold` or `land` or `rtl` stops it" in err


def test_command_line_names_the_command_that_stops(capsys):
    async def scenario(session, world):
        await run_line(session, "mode guided; arm")
        notice = notice_of_interruption(session.vehicle, "takeoff", "mav vehicle ")
        with pytest.raises(asyncio.CancelledError), notice:
            raise asyncio.CancelledError

    in_shell(COPTER, scenario)
    assert "`mav vehicle hold --system 1`" in capsys.readouterr().err
