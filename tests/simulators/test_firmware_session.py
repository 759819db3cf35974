"""Worlds with the program of a firmware, and stand-ins for such programs."""

from __future__ import annotations

import asyncio
import random
import shlex
import sys
from pathlib import Path

import pytest

from mavstack.errors import InvalidArgumentError, InvalidStateError, LinkError
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.firmware_command import FirmwareCommand
from mavstack.simulators.firmware_process import FirmwareProcess
from mavstack.simulators.firmware_session import FirmwareOptions, FirmwareSession
from mavstack.vehicle import connect
from tests.simulators.firmwares import free_port, until

SITL = f"{shlex.quote(sys.executable)} {shlex.quote(str(Path(__file__).with_name('stand_in_sitl.py')))}"


def options(**changes):
    """Return the options of a stand-in; its instance keeps ports of tests apart."""
    return FirmwareOptions(
        "ardupilot",
        binary=SITL,
        listen="udpin://127.0.0.1:0",
        instance=random.randrange(200, 5000),
        out=(f"tcpin://127.0.0.1:{free_port()}",),
        **changes,
    )


async def test_a_program_flies_and_its_vehicle_is_offered():
    lines, events = [], []
    async with FirmwareSession(options(), on_event=events.append, on_line=lines.append) as session:
        run = asyncio.ensure_future(session.run())
        async with connect(session.url) as connection:
            vehicle = await asyncio.wait_for(connection.wait_for_vehicle(), 60)
            assert vehicle.address.system == 1
        await until(lambda: session.simulator.time > 0.5)
        run.cancel()
    assert events == ["ArduPilot is connected"]
    assert lines[0].startswith("parameters: ['SIM_RATE_HZ', '400', 'FRAME_CLASS', '1'")
    assert session._process is not None
    assert not session._process.folder.exists()


async def test_a_program_that_ends_ends_the_run(tmp_path):
    script = tmp_path / "short.py"
    script.write_text("print('done'); raise SystemExit(3)")
    made = options()
    command = f"{shlex.quote(sys.executable)} {shlex.quote(str(script))}"
    changed = FirmwareOptions("betaflight", binary=command, listen=f"udpin://127.0.0.1:{free_port()}")
    assert made.binary != changed.binary
    async with FirmwareSession(changed) as session:
        with pytest.raises(LinkError, match="the program of betaflight ended with code 3"):
            # Not when the time has passed in which it would open its serial ports.
            await asyncio.wait_for(session.run(), 10)


async def test_a_program_that_ignores_signals_is_killed(tmp_path, monkeypatch):
    monkeypatch.setattr("mavstack.simulators.firmware_process.GRACE", 0.2)
    script = tmp_path / "deaf.py"
    script.write_text(
        "import signal, time\nsignal.signal(signal.SIGTERM, signal.SIG_IGN)\nprint('deaf', flush=True)\n"
        "while True: time.sleep(1)"
    )
    lines = []
    process = FirmwareProcess(
        FirmwareCommand((sys.executable, str(script))), folder=tmp_path / "own", on_line=lines.append
    )
    async with process:
        await until(lambda: lines)
    assert await process.wait() == -9
    assert (tmp_path / "own").is_dir()


async def test_a_program_that_cannot_start_is_reported(tmp_path):
    with pytest.raises(InvalidStateError, match="starting /no/such failed: No such file"):
        async with FirmwareProcess(FirmwareCommand(("/no/such",))):
            pass


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"firmware": "inav"}, "there is no firmware 'inav'"),
        ({"vehicle": "kite"}, "there is no vehicle 'kite'"),
        ({"instance": -1}, "the instance must be 0 or more"),
        ({"binary": "/no/such"}, "the program '/no/such' is not a file"),
        ({"physics": "kite"}, "there is no physics 'kite'"),
    ],
)
def test_wrong_options_are_refused(changes, problem):
    with pytest.raises(InvalidArgumentError, match=problem):
        FirmwareSession(FirmwareOptions(**{"firmware": "ardupilot"} | changes))


@pytest.mark.parametrize(
    ("firmware", "vehicle", "altitude"),
    [("ardupilot", "sub", 0.0), ("ardupilot", "boat", 488.0), ("px4", "sub", 488.0)],
)
def test_submarines_of_ardupilot_begin_at_sea_level(firmware, vehicle, altitude):
    session = FirmwareSession(FirmwareOptions(firmware, vehicle=vehicle))
    assert session.simulator.home.altitude == altitude
    given = FirmwareOptions(firmware, vehicle=vehicle, home=DEFAULT_HOME)
    assert FirmwareSession(given).simulator.home == DEFAULT_HOME


def test_urls_of_the_vehicles():
    assert FirmwareSession(FirmwareOptions("px4", instance=2)).url == "udpin://127.0.0.1:14542"
    assert FirmwareSession(FirmwareOptions("ardupilot")).url == "udpin://127.0.0.1:14550"
    assert FirmwareSession(FirmwareOptions("betaflight")).url == "msp+tcp://127.0.0.1:5761"
