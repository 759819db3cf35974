from __future__ import annotations

import pytest

from mavstack.cli.common.errors import UsageError
from mavstack.cli.sim.video import filming
from mavstack.sim import BackgroundSimulator
from tests.links.test_tcp import free_port

pytest.importorskip("aiortc")


async def test_each_camera_announces_the_stream_on_its_port():
    simulator = BackgroundSimulator()
    vehicle = simulator.simulation.add("copter", camera=True, system=2)
    port = free_port()
    async with filming(simulator.simulation.vehicles, port) as urls:
        assert urls == [f"rtsp://127.0.0.1:{port}/camera"]
        assert vehicle.camera.device.streams[0].uri == urls[0]


async def test_without_the_option_nothing_streams():
    async with filming([], None) as urls:
        assert urls == []


@pytest.mark.parametrize("port", [0, -1, 70000])
async def test_a_port_that_is_none_is_refused(port):
    with pytest.raises(UsageError, match="--video must be a port"):
        async with filming([], port):
            pass
