from __future__ import annotations

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.http.bodies import RefusedError
from mavstack.server.station import TELEMETRY_RATES, Station
from mavstack.vehicle import Connection
from mavstack.vehicle.telemetry import Telemetry
from tests.server.stations import COPTER, PX4_COPTER, Ground, serve


def test_telemetry_home_and_version_are_requested() -> None:
    async def scenario(ground: Ground) -> None:
        vehicle, latest = ground.station.vehicle(1), ground.station.packets.latest

        def rate(message: type) -> float:
            found = latest.find(1, message.__mavlink_row__[0])
            return 0.0 if found is None else found.rate(ground.station.connection.now())

        await ground.wait_until(
            lambda: all(rate(each) > 0.8 * wanted for each, wanted in TELEMETRY_RATES.items() if each in SENT)
        )
        await ground.wait_until(lambda: vehicle.version and vehicle.home)

    serve(COPTER, scenario, full_telemetry=True)


#: The messages that a simulated copter on the ground sends at these rates.
SENT = {common.Attitude, common.GlobalPositionInt, common.VfrHud, common.SysStatus}


@pytest.mark.parametrize(
    ("kind", "more"),
    [
        (COPTER, {common.FenceStatus, ardupilotmega.Wind, ardupilotmega.EkfStatusReport}),
        (PX4_COPTER, {common.EstimatorStatus}),
    ],
)
def test_fence_wind_and_estimator_are_requested_as_the_firmware_has_them(monkeypatch, kind, more) -> None:
    requested: dict[type, float] = {}
    ensure = Telemetry.ensure

    async def note(telemetry: Telemetry, message: type, rate: float) -> None:
        requested[message] = rate
        await ensure(telemetry, message, rate)

    monkeypatch.setattr(Telemetry, "ensure", note)

    async def scenario(ground: Ground) -> None:
        latest = ground.station.packets.latest
        await ground.wait_until(lambda: requested.keys() == TELEMETRY_RATES.keys() | more)
        assert {requested[each] for each in more} == {1.0}
        # A vehicle without a fence has no status of it.
        sent = more - {common.FenceStatus}
        await ground.wait_until(lambda: all(latest.find(1, each.__mavlink_row__[0]) for each in sent))

    serve(kind, scenario, full_telemetry=True)


async def test_unknown_vehicles_are_refused() -> None:
    async with Station() as station:
        with pytest.raises(RefusedError, match="no vehicle with system id 5 was found; known: none"):
            station.vehicle(5)


async def test_links_of_the_connection_are_sources() -> None:
    async with Station(Connection("udpin://127.0.0.1:0")) as station:
        (source,) = station.sources.list()
        assert source.values()["state"] == "waiting"
        await station.sources.remove(source.id)
        assert station.connection.links == []


async def test_closing_twice() -> None:
    station = await Station().open()
    await station.close()
    await station.close()
    assert not station.connection.is_open
