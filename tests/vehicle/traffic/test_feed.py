"""Traffic of a receiver over a real socket, to a simulated vehicle."""

from __future__ import annotations

import asyncio

import pytest

from mavstack import connect
from mavstack.dialects import common
from mavstack.errors import LinkURLError
from mavstack.sim import BackgroundSimulator
from mavstack.vehicle.traffic import TrafficFeed
from tests.traffic.test_sbs import NAME


async def receiver(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """An aircraft 200 m from the vehicle, at its height."""
    line = "MSG,3,1,1,4CA2D6,1,,,,,,1640,,,47.3995,8.5456,,,0,0,0,0\r\n"
    writer.write(NAME + line.encode() * 3)
    await reader.read()
    writer.close()


async def test_traffic_reaches_the_vehicle_and_raises_an_alarm():
    server = await asyncio.start_server(receiver, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    shown: list[common.AdsbVehicle] = []
    with BackgroundSimulator(count=2) as simulator:
        simulator.call(lambda: watch(simulator.vehicle, shown))
        async with connect(simulator.url) as connection:
            await connection.wait_for_vehicles(2)
            async with (
                TrafficFeed(connection, f"sbs://127.0.0.1:{port}", fleet=True) as feed,
                asyncio.timeout(30),
            ):
                alarms = feed.alarms()
                found = {(await anext(alarms)).aircraft.callsign for _ in range(3)}
                assert "RYR1427" in found
                assert found & {"MAV1", "MAV2"}
                assert feed.reports == 4
                while not {each.ICAO_address for each in shown} >= {0x4CA2D6, 0xF00001}:  # noqa: ASYNC110
                    await asyncio.sleep(0.05)
                await alarms.aclose()
    server.close()


def watch(vehicle, shown) -> None:
    """Keep the ADSB_VEHICLE that a simulated vehicle receives."""
    receive = vehicle.receive

    def watched(port, data):
        packets = receive(port, data)
        shown.extend(packet.message for packet in packets if isinstance(packet.message, common.AdsbVehicle))
        return packets

    vehicle.receive = watched


def test_malformed_sources():
    for url in ("http://a", "sbs://", "30003", "sbs://a:b"):
        with pytest.raises(LinkURLError):
            TrafficFeed(None, url)
