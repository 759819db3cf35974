from __future__ import annotations

import json

import pytest

from mavstack.cli.demo.flights import FLIGHTS, flight_home, flight_plan
from mavstack.dialects import common
from mavstack.sim.vehicle_types import Firmware


@pytest.mark.nightly
def test_summary_as_json(mav):
    result = mav("demo", "--for", "40", "--json")
    assert (result.code, result.err) == (0, "")
    summary = json.loads(result.out)
    vehicles = summary["vehicles"]
    assert [vehicle["system"] for vehicle in vehicles] == [1, 2, 3, 4, 5, 6, 7, 8]
    assert all(vehicle["armed"] for vehicle in vehicles), vehicles
    assert all(vehicle["mode"] in ("AUTO", "MISSION") for vehicle in vehicles[:7])
    assert vehicles[7]["height_m"] == pytest.approx(15, abs=3)
    copter, _, plane, _, rover, _, submarine, _ = vehicles
    assert copter["height_m"] == pytest.approx(20, abs=2)
    assert plane["speed_m_s"] > 10
    assert plane["height_m"] > 30
    assert abs(rover["height_m"]) < 1
    assert submarine["height_m"] < -2
    assert summary["texts"]


@pytest.mark.nightly
def test_summary_without_a_terminal(mav):
    result = mav("demo", "--for", "5")
    assert (result.code, result.err) == (0, "")
    assert result.out.count("\n") == 9
    assert "ArduPilot quadrotor" in result.out
    assert "PX4 VTOL" in result.out


@pytest.mark.nightly
@pytest.mark.timeout(900)  # three demos of eight vehicles, on a busy machine
def test_equal_seeds_give_equal_flights(mav):
    first, second, other = (mav("demo", "--for", "8", "--json", "--seed", seed).out for seed in (3, 3, 4))
    assert first == second != other


@pytest.mark.flight
def test_no_output_with_out_in_a_pipe(mav):
    result = mav("demo", "--out", "udpout://127.0.0.1:9", "--for", "0.1")
    assert (result.code, result.out, result.err) == (0, "", "")


@pytest.mark.parametrize("flight", FLIGHTS, ids=lambda flight: f"{flight.firmware}-{flight.type}")
def test_mission_repeats(flight):
    items = flight_plan(flight, flight_home(flight)).items
    jump = items[-1]
    assert jump.command == common.MavCmd.DO_JUMP
    assert jump.param2 == -1
    first = items[int(jump.param1)]
    assert first.command == common.MavCmd.NAV_WAYPOINT
    assert first.param7 == flight.height
    takes_off = any("TAKEOFF" in item.name for item in items)
    assert takes_off == flight.type.flies
    assert int(jump.param1) == takes_off + (flight.firmware is Firmware.ARDUPILOT)
