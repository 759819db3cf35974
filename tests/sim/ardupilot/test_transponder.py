"""The messages of a simulated ArduPilot to a transponder that speaks MAVLink."""

from __future__ import annotations

import pytest

from mavstack.dialects import uavionix
from tests.sim.harness import VehicleHarness, airborne

HEALTHY = uavionix.UavionixAdsbTransceiverHealthReport(rfHealth=uavionix.UavionixAdsbRfHealth.OK)


def of_kind(one: VehicleHarness, kind: type) -> list:
    return [message for message in one.received if isinstance(message, kind)]


def beating(one: VehicleHarness, seconds: int) -> None:
    """Let a transceiver report its health each second."""
    for _ in range(seconds):
        one.send(HEALTHY)
        one.run(1)


def test_a_transceiver_gets_configuration_and_position():
    one = airborne("copter", "ardupilot", ADSB_TYPE=1)
    one.receiving = True
    beating(one, 12)
    dynamic, configurations = (
        of_kind(one, uavionix.UavionixAdsbOutDynamic), of_kind(one, uavionix.UavionixAdsbOutCfg)
    )  # fmt: skip
    assert 55 <= len(dynamic) <= 62, "5 Hz"
    assert len(configurations) == 3, "each 5 s"
    assert configurations[0].callsign == "ARDU0001"
    truth = one.vehicle.body.truth
    latitude, longitude, _ = one.vehicle.body.frame.to_global(truth.north, truth.east, truth.down)
    assert dynamic[-1].gpsLat / 1e7 == pytest.approx(latitude, abs=1e-4)
    assert dynamic[-1].gpsLon / 1e7 == pytest.approx(longitude, abs=1e-4)
    assert (dynamic[-1].squawk, int(dynamic[-1].state)) == (1200, 0)


def test_a_silent_transceiver_is_reported():
    one = airborne("copter", "ardupilot", ADSB_TYPE=1)
    one.receiving = True
    beating(one, 1)
    one.run(11)
    assert "ADSB: Transceiver heartbeat timed out" in one.texts
    before = len(of_kind(one, uavionix.UavionixAdsbOutDynamic))
    assert before
    one.run(2)
    assert len(of_kind(one, uavionix.UavionixAdsbOutDynamic)) == before


def test_a_ground_station_configures_what_is_sent():
    one = airborne("copter", "ardupilot", ADSB_TYPE=1)
    one.receiving = True
    one.send(uavionix.UavionixAdsbOutCfg(ICAO=0x3C1234, callsign="LX1"))
    beating(one, 1)
    assert "ADSB: Using ICAO_id 3936820 and Callsign LX1" in one.texts
    assert of_kind(one, uavionix.UavionixAdsbOutCfg)[0].ICAO == 0x3C1234


@pytest.mark.parametrize("kind", [0, 3])
def test_only_a_transceiver_at_mavlink_is_served(kind):
    one = airborne("copter", "ardupilot", ADSB_TYPE=kind)
    one.receiving = True
    beating(one, 3)
    assert not of_kind(one, uavionix.UavionixAdsbOutDynamic)
