"""The recording of a node, over memory links."""

from __future__ import annotations

import asyncio

import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.sim.virtual import run_virtually


def run_pair(scenario):
    """Run a scenario with two nodes, a station and a vehicle, that hear each other."""

    async def run():
        network = MemoryNetwork()
        async with (
            Node(network.link(), system=255, component=190) as station,
            Node(network.link(), system=1, component=1) as vehicle,
        ):
            await asyncio.sleep(0.1)  # the channels are open
            await scenario(station, vehicle)

    run_virtually(run())


def test_received_and_sent_packets_are_recorded(tmp_path):
    path = tmp_path / "flight.tlog"

    async def scenario(station, vehicle):
        async with station.record(path) as recording:
            vehicle.send(common.Attitude(roll=0.5))
            station.send(common.SystemTime(time_boot_ms=7))
            await asyncio.sleep(0.5)
            assert recording.packets == 2 + len(open_log(path).get("HEARTBEAT", ()))
            assert recording.files == (path,)
        vehicle.send(common.Attitude(roll=0.7))
        await asyncio.sleep(0.5)

    run_pair(scenario)
    log = open_log(path)
    assert list(log["ATTITUDE"]["roll"]) == [0.5]
    assert list(log["ATTITUDE"]["_system"]) == [1]
    assert list(log["SYSTEM_TIME"]["_system"]) == [255]


def test_sent_packets_are_left_out_on_request(tmp_path):
    path = tmp_path / "flight.tlog"

    async def scenario(station, vehicle):
        async with station.record(path, sent=False):
            vehicle.send(common.Attitude())
            station.send(common.SystemTime())
            await asyncio.sleep(3)

    run_pair(scenario)
    log = open_log(path)
    assert "SYSTEM_TIME" not in log
    assert set(log["HEARTBEAT"]["_system"]) == {1}


def test_the_files_have_a_limited_size(tmp_path):
    async def scenario(station, vehicle):
        async with station.record(tmp_path / "flight.tlog", max_duration=2, keep=2) as recording:
            for _ in range(9):
                vehicle.send(common.Attitude())
                await asyncio.sleep(1)
            assert len(recording.files) > 2

    run_pair(scenario)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_full_disk_ends_the_recording_and_not_the_node(tmp_path):
    reports = []

    async def scenario(station, vehicle):
        asyncio.get_running_loop().set_exception_handler(lambda loop, context: reports.append(context))
        recording = station.record(tmp_path / "flight.tlog")

        def full(data):
            raise LogError("no space left")

        recording._recorder._file.append = full
        for _ in range(3):
            vehicle.send(common.Attitude())
            await asyncio.sleep(0.5)
        assert station.components
        with pytest.raises(LogError, match="no space left"):
            recording.close()
        recording._recorder._file.append = lambda data: None

    run_pair(scenario)
    assert [report["message"] for report in reports] == ["the recording ended: no space left"]


def test_an_existing_file_is_refused(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"")

    async def scenario(station, vehicle):
        with pytest.raises(LogError, match="never overwrites"):
            station.record(path)

    run_pair(scenario)
