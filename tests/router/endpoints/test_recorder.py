from __future__ import annotations

import pytest

from mavstack import encode, open_log
from mavstack.dialects import common
from mavstack.errors import LinkError, LogError
from mavstack.router.config import EndpointConfig, Recording
from mavstack.router.endpoints import ENDED
from tests.router.peers import UdpPeer, arm, heartbeat, names, port, routing, until

VEHICLE = EndpointConfig("vehicle", "udpin://127.0.0.1:0")


async def test_packets_are_in_the_file(tmp_path):
    path = tmp_path / "logs" / "flight.tlog"
    async with routing(VEHICLE, EndpointConfig("box", record=Recording(str(path)))) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle:
            for number in range(5):
                vehicle.send(heartbeat(sequence=number))
            await until(lambda: path.stat().st_size == 5 * (len(heartbeat()) + 8))
    assert len(open_log(path)["HEARTBEAT"]) == 5


async def test_packets_with_a_target_are_in_the_file(tmp_path):
    path = tmp_path / "flight.tlog"
    ground_station = EndpointConfig("ground", "udpin://127.0.0.1:0")
    box = EndpointConfig("box", record=Recording(str(path)))
    async with routing(VEHICLE, ground_station, box) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle, UdpPeer(port(router, "ground")) as ground:
            vehicle.send(heartbeat())
            vehicle.send(heartbeat(sequence=1))  # a new peer gets three times what it sent
            await until(lambda: router.statistics().routes)
            ground.send(heartbeat(255, 190) + arm() + arm(target=99))
            assert names(await vehicle.receive() + await vehicle.receive()) == ["HEARTBEAT", "COMMAND_LONG"]
            ack = encode(
                common.CommandAck(command=400, target_system=255, target_component=190), system=1, component=1
            )
            vehicle.send(ack)
            assert await ground.receive() == ack
            await until(lambda: len(open_log(path).get("COMMAND_ACK", ())) == 1)
    log = open_log(path)
    assert (len(log["HEARTBEAT"]), len(log["COMMAND_LONG"])) == (3, 2)


async def test_files_of_limited_size(tmp_path):
    size = 2 * (len(heartbeat()) + 8)
    recording = Recording(str(tmp_path / "flight.tlog"), max_size=size, keep=2)
    async with routing(VEHICLE, EndpointConfig("box", record=recording)) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle:
            vehicle.send(heartbeat() * 7)
            await until((tmp_path / "flight-0004.tlog").exists)
    assert [each.name for each in sorted(tmp_path.iterdir())] == ["flight-0003.tlog", "flight-0004.tlog"]


async def test_an_existing_file_is_not_overwritten(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"x")
    with pytest.raises(LinkError, match="endpoint box: cannot record to"):
        async with routing(EndpointConfig("box", record=Recording(str(path)))):
            pass
    assert path.read_bytes() == b"x"


async def test_a_full_disk_ends_the_recording_alone(tmp_path, monkeypatch):
    def fail(*_):
        raise LogError("no space left")

    monkeypatch.setattr("mavstack.logs.recorder.recorder.Recorder.write", fail)
    config = EndpointConfig("box", record=Recording(str(tmp_path / "flight.tlog")))
    async with routing(VEHICLE, config, EndpointConfig("ground", "udpin://127.0.0.1:0")) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle, UdpPeer(port(router, "ground")) as ground:
            ground.send(heartbeat(255))
            await until(lambda: router.endpoints["box"].state == ENDED)
            assert router.endpoints["box"].reason == "no space left"
            vehicle.send(heartbeat())
            assert await ground.receive() == heartbeat()
