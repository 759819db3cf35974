"""Simulated flight controllers beside other programs: YAMSPy is a client, Betaflight's SITL the model."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
import time
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.msp import FlightController
from mavstack.errors import MspDenied
from mavstack.msp import Direction
from mavstack.msp.messages.config import CfSerialConfig, SerialConfig
from mavstack.msp.messages.registry import all_messages, request_types
from mavstack.sim.msp import betaflight_settings
from tests.interop.betaflight import URL, betaflight_sitl, needs_betaflight
from tests.sim.msp.peer import Peer

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.interop

#: Replies whose size depends on the board: texts, ports, boxes, channels, meters, the OSD.
OF_THE_BOARD = {
    3,
    4,
    5,
    10,
    77,
    84,
    105,
    116,
    119,
    128,
    129,
    189,
    CfSerialConfig.COMMAND,
    SerialConfig.COMMAND,
}


@pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo terminals")
def test_yamspy_reads_and_arms_a_simulated_controller(tmp_path: Path) -> None:
    yamspy = pytest.importorskip("yamspy", reason="YAMSPy is not installed")
    terminal = tmp_path / "ttyBF"
    words = ["sim", "--firmware", "betaflight", "--out", f"msp+pty://{terminal}", "--for", "60"]
    with subprocess.Popen([sys.executable, "-m", "mavstack", *words], stdout=subprocess.PIPE) as program:
        try:
            assert program.stdout is not None
            assert program.stdout.readline()  # its terminal is open then
            armed = _arm_by_yamspy(yamspy.MSPy, terminal, tmp_path)
        finally:
            program.terminate()
    assert armed


def _arm_by_yamspy(connect: Any, terminal: Path, folder: Path) -> bool:
    """Read telemetry and arm by the channels, all by YAMSPy; returns whether it reports the vehicle armed."""
    with connect(str(terminal), logfilename=str(folder / "yamspy.log"), loglevel="WARNING") as board:
        assert (board.CONFIG["flightControllerIdentifier"], board.CONFIG["boardIdentifier"]) == (
            "BTFL",
            "S405",
        )
        _ask(board, "MSP_RAW_GPS")
        assert board.GPS_DATA["lat"] == pytest.approx(473977418, abs=2000)
        for switch in [1000] * 65 + [1800] * 20:
            board.send_RAW_RC([1500, 1500, 1000, 1500, switch, 1000, 1000, 1000])
            board.receive_msg()
            _ask(board, "MSP_STATUS_EX")
            if board.bit_check(board.CONFIG["mode"], 0):
                return True
            time.sleep(0.1)
    return False


def _ask(board: Any, name: str) -> None:
    board.send_RAW_msg(type(board).MSPCodes[name], data=[])
    board.process_recv_data(board.receive_msg())


@needs_betaflight
async def test_replies_have_the_sizes_of_betaflights_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        async with FlightController(URL) as real:
            info = dataclasses.replace(betaflight_settings.INFO, version=real.info.version, api=real.info.api)
            monkeypatch.setattr(betaflight_settings, "INFO", info)
            peer, compared = Peer(), 0
            for kind in all_messages():
                is_read = kind.IS_REPLY and "BTFL" in kind.VARIANTS and not request_types(kind.COMMAND)
                if not is_read or kind.COMMAND in OF_THE_BOARD:
                    continue
                reply = peer.request(kind.COMMAND)
                assert reply is not None
                try:
                    expected = await real.request(kind.COMMAND)
                except MspDenied:
                    continue
                if reply.direction is Direction.RESPONSE:
                    assert len(reply.payload) == len(expected), kind.NAME
                    compared += 1
            assert compared >= 40
