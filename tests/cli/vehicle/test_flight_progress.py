"""The line that tells how a flight gets on."""

from __future__ import annotations

import asyncio
import io

import pytest

from mavstack.cli.shell.runner import run_line
from mavstack.cli.vehicle.flight_progress import (
    distance_to_altitude,
    distance_to_home,
    distance_to_place,
    flight_progress,
    progress_text,
)
from mavstack.dialects import common
from tests.cli.shell.shell_session import COPTER, in_shell


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.flight
def test_shown_on_a_terminal_and_erased(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)

    async def scenario(session, world):
        await run_line(session, "mode guided; arm; takeoff 20")

    in_shell(COPTER, scenario)
    text = terminal.getvalue()
    assert "takeoff: " in text
    assert " m to go, GUIDED" in text
    assert text.endswith("\r\x1b[K")


@pytest.mark.flight
def test_no_output_in_a_pipe(capsys):
    async def scenario(session, world):
        async with flight_progress(session.vehicle, "waiting"):
            await asyncio.sleep(3)

    in_shell(COPTER, scenario)
    assert capsys.readouterr().err == ""


def test_remaining_distance(capsys):
    async def scenario(session, world):
        vehicle = session.vehicle
        await vehicle.wait_for_message(common.GlobalPositionInt)
        await vehicle.telemetry.request_home()
        assert distance_to_altitude(20.0)(vehicle) == pytest.approx(20, abs=1)
        north, east = world.simulated.body.frame.to_global(30.0, 40.0, 0.0)[:2]
        assert distance_to_place(north, east)(vehicle) == pytest.approx(50, abs=2)
        assert distance_to_home(vehicle) == pytest.approx(0, abs=2)
        text = progress_text(vehicle, "going", distance_to_place(north, east))
        assert text.startswith("going: ")
        assert text.endswith(" m to go, STABILIZE")

    in_shell(COPTER, scenario)
