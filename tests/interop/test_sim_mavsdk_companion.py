"""MAVSDK's Rtk and Transponder plugins with simulated vehicles."""

from __future__ import annotations

import asyncio
from base64 import b64encode

import pytest

from mavstack.dialects import common
from mavstack.wire import encode
from tests.gnss.test_rtcm import msm, station
from tests.interop.mavsdk_peer import mavsdk_object, needs_mavsdk
from tests.interop.simulated import simulated_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]
ADDRESS = 0x4CA2D6


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
async def test_corrections_of_mavsdk_improve_the_fix(firmware):
    async with simulated_flight("copter", firmware, speed=1.0) as flight:
        for epoch in range(40):
            for frame in (station(), msm(1074, epoch, 250), msm(1084, epoch, 400)):
                data = mavsdk_object("rtk.RtcmData", data_base64=b64encode(frame.data).decode())
                await flight.call_ok("rtk", "send_rtcm_data", data)
            if flight.vehicle.body.sensors.gps_fix == common.GpsFixType.RTK_FLOAT:
                break
            await asyncio.sleep(0.3)
        assert flight.vehicle.body.sensors.gps_fix == common.GpsFixType.RTK_FLOAT


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
async def test_mavsdk_shows_the_aircraft_of_a_vehicle(firmware):
    async with simulated_flight("copter", firmware, speed=1.0) as flight:
        aircraft = await flight.ground.stream("transponder", "subscribe_transponder")
        place = flight.vehicle.body.frame.to_global(500.0, 0.0, -200.0)
        flags = common.AdsbFlags.VALID_COORDS | common.AdsbFlags.VALID_ALTITUDE
        report = common.AdsbVehicle(
            ICAO_address=ADDRESS, lat=round(place[0] * 1e7), lon=round(place[1] * 1e7),
            altitude=round(place[2] * 1e3), callsign="RYR1427", emitter_type=3, flags=flags,
        )  # fmt: skip
        flight.vehicle.receive(flight.vehicle.open_port("receiver"), encode(report, system=1, component=156))
        found = await aircraft.wait_for(lambda each: each["icao_address"] == ADDRESS)
        assert found["callsign"].startswith("RYR1427")
        assert found["latitude_deg"] == pytest.approx(place[0], abs=1e-6)
