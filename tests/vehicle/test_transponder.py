"""The transponder of a simulated ArduPilot, as a ground station sets it."""

from __future__ import annotations

import pytest

from mavstack.dialects import common, uavionix
from mavstack.errors import (
    ActionTimeout,
    ActionUnsupported,
    CommandDenied,
    InvalidArgumentError,
    MessageTimeout,
)
from mavstack.vehicle.transponder import TransponderStatus, _agrees


@pytest.mark.vehicle(firmware="ardupilot")
def test_a_transponder_is_set(virtual_vehicle):
    async def flight(vehicle):
        assert vehicle.transponder.status is None
        await vehicle.params.set("ADSB_TYPE", 3)
        lost = uavionix.UavionixAdsbEmergencyStatus.NO_COMM_EMERGENCY
        found = await vehicle.transponder.set(squawk="7600", flight_id="LX 1  ", ident=True, emergency=lost)
        assert found == TransponderStatus("7600", "LX 1", True, True, True, True, 35)
        assert vehicle.transponder.status == found == await vehicle.transponder.get()
        standby = await vehicle.transponder.set(squawk="0021", transmits=False)
        assert standby == TransponderStatus("0021", "", False, False, False, True, 35)
        assert not (await vehicle.transponder.set(altitude=False)).altitude
        await vehicle.params.set("ADSB_TYPE", 0)
        with pytest.raises(ActionTimeout):  # the last report agrees, but is older
            await vehicle.transponder.set(altitude=False, timeout=3)

    virtual_vehicle.run(flight)


def test_a_report_agrees_in_modes_squawk_and_flight():
    control = uavionix.UavionixAdsbOutControl(state=128, squawk=7000, flight_id="LX1")
    same = {"state": 128 | 1, "squawk": 7000, "flight_id": "LX1  "}
    assert _agrees(uavionix.UavionixAdsbOutStatus(**same), control)
    for change in ({"state": 0}, {"squawk": 1200}, {"flight_id": "LX2"}):
        assert not _agrees(uavionix.UavionixAdsbOutStatus(**same | change), control)


@pytest.mark.vehicle(firmware="ardupilot")
def test_a_vehicle_without_transponder(virtual_vehicle):
    async def flight(vehicle):
        with pytest.raises(ActionTimeout, match="setting the transponder of 1/1 failed: not done in 3 s"):
            await vehicle.transponder.set(timeout=3)
        with pytest.raises((CommandDenied, MessageTimeout)):
            await vehicle.transponder.get(timeout=3)

    virtual_vehicle.run(flight)


@pytest.mark.vehicle(firmware="px4")
def test_px4_does_not_report_its_transponder(virtual_vehicle):
    async def flight(vehicle):
        with pytest.raises(
            CommandDenied, match="PX4 does not report its transponder; read ADSB_SQUAWK"
        ) as caught:
            await vehicle.transponder.get(timeout=3)
        assert caught.value.code == common.MavResult.DENIED

    virtual_vehicle.run(flight)


@pytest.mark.vehicle(firmware="ardupilot")
@pytest.mark.parametrize(
    ("values", "problem"),
    [
        ({"squawk": "7800"}, "a squawk must be four digits from 0 to 7, got '7800'"),
        ({"squawk": "12"}, "squawk"),
        ({"flight_id": "lx1"}, "a flight id must be up to 8 of A to Z"),
        ({"flight_id": "ABCDEFGHI"}, "flight id"),
        ({"emergency": 8}, "an emergency must be 0 to 7, got 8"),
    ],
)
def test_impossible_values_are_not_sent(virtual_vehicle, values, problem):
    async def flight(vehicle):
        with pytest.raises(InvalidArgumentError, match=problem):
            await vehicle.transponder.set(**values)

    virtual_vehicle.run(flight)


@pytest.mark.vehicle(firmware="ardupilot")
def test_the_identity_in_a_transponder_that_speaks_mavlink(virtual_vehicle):
    virtual_vehicle.vehicle.has_transponder = True
    virtual_vehicle.vehicle.reboot()

    async def flight(vehicle):
        transponder = vehicle.transponder
        assert await transponder.get_registration() == ""
        await transponder.set_registration("N8644B  ")
        await transponder.set_flight_id("LX 1")
        assert await transponder.get_registration() == "N8644B"
        assert await transponder.get_flight_id() == "LX 1"
        with pytest.raises(InvalidArgumentError, match="a registration must be up to 8"):
            await transponder.set_registration("N-8644B")
        with pytest.raises(InvalidArgumentError, match="a flight id must be up to 8"):
            await transponder.set_flight_id("lx1")

    virtual_vehicle.run(flight)


@pytest.mark.vehicle(firmware="px4")
def test_px4_without_transponder(virtual_vehicle):
    async def flight(vehicle):
        with pytest.raises(ActionUnsupported, match="set ADSB_SQUAWK and ADSB_EMERGC instead"):
            await vehicle.transponder.set()
        with pytest.raises(ActionTimeout, match="reading UAVIONIX_ADSB_OUT_CFG_FLIGHTID of 1/1 failed"):
            await vehicle.transponder.get_flight_id(timeout=3)
        with pytest.raises(ActionTimeout, match="setting UAVIONIX_ADSB_OUT_CFG_REGISTRATION of 1/1 failed"):
            await vehicle.transponder.set_registration("N1", timeout=3)

    virtual_vehicle.run(flight)
