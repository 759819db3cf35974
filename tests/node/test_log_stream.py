"""A log is streamed by a simulated PX4; an ArduPilot has none."""

from __future__ import annotations

import pytest

from mavstack import open_log
from mavstack.errors import CommandDenied


@pytest.mark.vehicle(firmware="px4", loss=0.05)
def test_a_log_over_a_link_with_losses(virtual_vehicle, tmp_path):
    async def flight(vehicle):
        path = tmp_path / "stream.ulg"
        with path.open("wb") as file:
            async with vehicle.log_stream.open() as stream:
                async for data in stream:
                    file.write(data)
                    if stream.blocks > 300:
                        break
                file.write(stream.drain())
                assert path.stat().st_size <= stream.size
                assert stream.lost > 0
        assert len(open_log(path)["sensor_combined"]) > 20
        assert vehicle.log_stream is vehicle.component.log_stream

    virtual_vehicle.run(flight)


def test_ardupilot_streams_no_log(virtual_vehicle):
    async def flight(vehicle):
        with pytest.raises(CommandDenied, match="UNSUPPORTED"):
            async with vehicle.log_stream.open():
                raise AssertionError

    virtual_vehicle.run(flight)
