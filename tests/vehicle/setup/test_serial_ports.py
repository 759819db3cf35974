"""The serial ports of ArduPilot and PX4."""

from __future__ import annotations

import pytest

from mavstack.vehicle.setup.serial_ports import serial_ports_of
from tests.server.stations import COPTER, Ground, serve


def test_ports_of_ardupilot() -> None:
    values = {"SERIAL1_PROTOCOL": 2, "SERIAL1_BAUD": 57, "SERIAL10_PROTOCOL": -1, "SERIAL3_PROTOCOL": 99}
    found = [(each.name, each.protocol, each.number, each.baud) for each in serial_ports_of(values)]
    assert found == [
        ("SERIAL1", "MAVLink 2", 2, 57600),
        ("SERIAL3", "protocol 99", 99, 0),
        ("SERIAL10", "none", -1, 0),
    ]


def test_ports_of_px4() -> None:
    values = {
        "SER_TEL1_BAUD": 57600, "SER_GPS1_BAUD": 0, "SER_TEL2_BAUD": 921600, "MAV_0_CONFIG": 101,
        "MAV_1_CONFIG": 0, "GPS_1_CONFIG": 201, "UXRCE_DDS_CFG": 101,
    }  # fmt: skip
    found = {each.name: (each.protocol, each.baud) for each in serial_ports_of(values)}
    assert found == {
        "GPS1": ("GPS_1", 0),
        "TEL1": ("MAV_0, UXRCE_DDS", 57600),
        "TEL2": ("none", 921600),
    }


@pytest.mark.parametrize(("baud", "stored"), [(57600, 57), (250000, 250000)])
def test_a_port_is_set(baud, stored) -> None:
    async def scenario(ground: Ground) -> None:
        listed = (await ground.api.get("/api/vehicles/1/serial-ports")).json
        assert listed["ports"][0]["name"] == "SERIAL0"
        assert {"number": 5, "name": "GPS"} in listed["protocols"]
        changed = await ground.api.put("/api/vehicles/1/serial-ports/SERIAL0", {"protocol": 1, "baud": baud})
        assert (changed.json["protocol"], changed.json["baud"]) == ("MAVLink 1", baud)
        parameters = ground.simulation.vehicles[0].parameters
        assert (parameters["SERIAL0_PROTOCOL"], parameters["SERIAL0_BAUD"]) == (1, stored)

    serve(COPTER, scenario)


def test_one_known_parameter_is_not_all() -> None:
    async def scenario(ground: Ground) -> None:
        await ground.api.get("/api/vehicles/1/parameters/RTL_ALT")
        assert (await ground.api.get("/api/vehicles/1/serial-ports")).json["ports"]

    serve(COPTER, scenario)


def test_refusals() -> None:
    async def scenario(ground: Ground) -> None:
        unknown = await ground.api.put("/api/vehicles/1/serial-ports/SERIAL9", {"baud": 9600})
        assert (unknown.status, "there is no serial port SERIAL9" in unknown.problem) == (400, True)
        wrong = await ground.api.put("/api/vehicles/1/serial-ports/SERIAL0", {"protocol": 77})
        assert (wrong.status, "77 is not the number of a protocol" in wrong.problem) == (400, True)

    serve(COPTER, scenario)
