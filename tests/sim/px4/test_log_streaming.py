"""A simulated PX4 streams its log: a valid .ulg for our reader and for pyulog, also with losses."""

from __future__ import annotations

from random import Random

import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.services.log_streaming import LogAssembler
from tests.sim.harness import CMD, RESULT
from tests.sim.px4.harness import Px4Harness

pyulog = pytest.importorskip("pyulog")


def stream(harness: Px4Harness, seconds: float, loss: float = 0.0, seed: int = 1) -> tuple[bytes, int]:
    """Receive a stream for a time as a client does; return the log and the number of lost blocks."""
    random, assembler = Random(seed), LogAssembler()
    log, lost, seen = b"", 0, len(harness.received)
    end = harness.vehicle.now + seconds
    while harness.vehicle.now < end:
        harness.run(0.02)
        messages, seen = harness.received[seen:], len(harness.received)
        for message in messages:
            if isinstance(message, common.LoggingDataAcked):
                harness.send(common.LoggingAck(1, 1, message.sequence))
            elif not isinstance(message, common.LoggingData) or random.random() < loss:
                continue
            found = assembler.add(
                message.sequence,
                message.data[: message.length],
                message.first_message_offset,
                harness.vehicle.now,
            )
            log, lost = log + found.data, lost + found.lost
    return log, lost


@pytest.mark.parametrize("loss", [0.0, 0.1])
def test_a_stream_is_a_log(tmp_path, loss):
    harness = Px4Harness()
    assert harness.command(CMD.LOGGING_START) == RESULT.ACCEPTED
    log, lost = stream(harness, 25, loss)
    assert bool(lost) == bool(loss)
    assert harness.command(CMD.LOGGING_STOP) == RESULT.ACCEPTED
    path = tmp_path / "stream.ulg"
    path.write_bytes(log)
    rows = len(open_log(path)["vehicle_attitude"])
    assert rows > (20 if loss else 100)
    found = pyulog.ULog(str(path))
    assert len(found.get_dataset("vehicle_attitude").data["timestamp"]) == rows
    assert bool(found.dropouts) == bool(loss)
    assert found.initial_parameters["SYS_AUTOSTART"] == harness.vehicle.parameters["SYS_AUTOSTART"]


def test_a_reboot_ends_the_stream():
    harness = Px4Harness()
    harness.command(CMD.LOGGING_START)
    assert len(harness.vehicle.storage.logs.streams) == 1
    harness.vehicle.reboot()
    assert harness.vehicle.storage.logs.streams == []


def test_a_client_that_does_not_acknowledge():
    harness = Px4Harness()
    harness.command(CMD.LOGGING_START)
    harness.run(15)
    assert harness.vehicle.storage.logs.streams == []
