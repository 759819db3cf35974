"""The ADS-B transponder beside a simulated vehicle, with both firmwares."""

from __future__ import annotations

import pytest

from mavstack.dialects import common, uavionix
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.harness import SimulationHarness, VehicleHarness

FLIGHT_ID, REGISTRATION = 10005, 10004


def beside(firmware: str, **parameters: float) -> VehicleHarness:
    """Return a vehicle with a transponder that booted with some parameters."""
    world = SimulationHarness()
    vehicle = world.simulation.add(VehicleType.COPTER, Firmware(firmware), transponder=True)
    one = world.attach(VehicleHarness(world, vehicle))
    for name, value in parameters.items():
        vehicle.parameters.set(name, value)
    vehicle.reboot()
    one.receiving = True
    one.run(15)
    return one


def of_kind(one: VehicleHarness, kind: type) -> list:
    return [message for message in one.received if isinstance(message, kind)]


def test_px4_configures_it_by_its_parameters():
    words = {"ADSB_CALLSIGN_1": 0x50583420, "ADSB_CALLSIGN_2": 0x37000000}  # "PX4 7"
    one = beside("px4", ADSB_ICAO_ID=0x3C1234, ADSB_SQUAWK=7000, ADSB_EMERGC=4, **words)
    transponder = one.vehicle.transponder
    assert (transponder.configuration.ICAO, transponder.configuration.callsign) == (0x3C1234, "PX4 7")
    assert transponder.configuration.emitterType == common.AdsbEmitterType.UAV
    dynamic = transponder.dynamic
    assert (dynamic.squawk, dynamic.emergencyStatus) == (7000, 4)
    assert dynamic.state == uavionix.UavionixAdsbOutDynamicState.ON_GROUND
    assert dynamic.gpsLat / 1e7 == pytest.approx(one.vehicle.body.sensors.gps_latitude, abs=1e-5)
    assert not of_kind(one, uavionix.UavionixAdsbOutDynamic), "only the transponder gets it"
    one.place_in_air(None)
    one.run(0.5)
    assert int(transponder.dynamic.state) == 0xFFFF, "as in its source"


def test_px4_does_not_send_an_impossible_callsign():
    one = beside("px4", ADSB_CALLSIGN_1=int.from_bytes(b"lx1\0", "big"))
    assert one.vehicle.transponder.configuration.callsign == ""


def test_ardupilot_serves_it_with_its_type_1():
    one = beside("ardupilot")
    assert one.vehicle.parameters["ADSB_TYPE"] == 1
    assert one.vehicle.transponder.configuration.callsign == "ARDU0001"
    assert one.vehicle.transponder.dynamic.squawk == 1200
    assert not of_kind(one, uavionix.UavionixAdsbOutDynamic)
    other = beside("ardupilot", ADSB_TYPE=0)
    assert other.vehicle.transponder.dynamic is None


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_a_ground_station_reads_and_sets_it(firmware):
    one = beside(firmware)
    healths = of_kind(one, uavionix.UavionixAdsbTransceiverHealthReport)
    assert len(healths) >= 10
    assert {int(each.rfHealth) for each in healths} == {1}
    one.send(uavionix.UavionixAdsbOutCfgFlightid(flight_id="LX1"))
    one.send(uavionix.UavionixAdsbOutCfgRegistration(registration="N8644B"))
    for number in (FLIGHT_ID, REGISTRATION, 10001, 10008):
        one.send(uavionix.UavionixAdsbGet(ReqMessageId=number))
    one.run(1)
    (flight,) = of_kind(one, uavionix.UavionixAdsbOutCfgFlightid)
    (registration,) = of_kind(one, uavionix.UavionixAdsbOutCfgRegistration)
    assert (flight.flight_id, registration.registration) == ("LX1", "N8644B")
    assert len(of_kind(one, uavionix.UavionixAdsbOutCfg)) == 1
    assert not of_kind(one, uavionix.UavionixAdsbOutStatus), "one that it does not have"


def test_a_ground_station_configures_it():
    one = beside("px4")
    one.send(uavionix.UavionixAdsbOutCfg(ICAO=1, callsign="LX2"))
    one.send(uavionix.UavionixAdsbGet(ReqMessageId=FLIGHT_ID))
    one.run(1)
    (flight,) = of_kind(one, uavionix.UavionixAdsbOutCfgFlightid)
    assert flight.flight_id == "LX2", "the callsign until one is set"
