"""MAVSDK's Failure and LogStreaming plugins with a simulated PX4."""

from __future__ import annotations

from base64 import b64decode

import pytest

from mavstack import open_log
from tests.interop.mavsdk_peer import needs_mavsdk
from tests.interop.simulated import simulated_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]


async def test_failures() -> None:
    async with simulated_flight("copter", "px4") as flight:
        flight.vehicle.parameters.set("SYS_FAILURE_EN", 1)
        await flight.call_ok("failure", "inject", GPS, OFF, 0)
        assert flight.vehicle.faults.active == {"gps": "gps off"}
        await flight.call_ok("failure", "inject", GPS, OK, 0)
        assert flight.vehicle.faults.active == {}
        await flight.call_fails("UNSUPPORTED", "failure", "inject", VIO, OFF, 0)
        flight.vehicle.parameters.set("SYS_FAILURE_EN", 0)
        await flight.call_fails("DISABLED|DENIED", "failure", "inject", GPS, OFF, 0)


async def test_log_streaming(tmp_path) -> None:
    async with simulated_flight("copter", "px4") as flight:
        with flight.real_time():
            pieces = await flight.ground.stream("log_streaming", "subscribe_log_streaming_raw")
            await flight.call_ok("log_streaming", "start_log_streaming")
            log = b""
            while len(log) < 80_000:
                log += b64decode((await pieces.get())["data_base64"])
            await flight.call_ok("log_streaming", "stop_log_streaming")
        path = tmp_path / "stream.ulg"
        path.write_bytes(log)
        assert len(open_log(path)["vehicle_attitude"]) > 5


#: Numbers of MAVSDK's FailureUnit and FailureType.
GPS, VIO = 4, 6
OK, OFF = 0, 1
