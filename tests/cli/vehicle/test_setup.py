"""`mav vehicle check`, `airframe` and `ports`, in virtual time."""

from __future__ import annotations

import json

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.cli.harness import CliHarness


def test_from_the_command_line(mav, monkeypatch) -> None:
    harness = CliHarness(monkeypatch, (VehicleType.COPTER, "px4"), ready=True)
    result = mav("vehicle", "check")
    assert result.out.splitlines()[0].split() == ["ok", "airframe", "selected"]
    harness.vehicle.parameters.set("COM_LOW_BAT_ACT", 0)
    result = mav("vehicle", "check", "--json")
    assert result.code == 1
    items = {each["name"]: each for each in json.loads(result.out)["items"]}
    assert items["low battery"]["remedy"] == "set COM_LOW_BAT_ACT, such as 3"


def test_the_check_requests_the_home(mav, monkeypatch) -> None:
    CliHarness(monkeypatch, (VehicleType.COPTER, "px4"), ready=True)
    items = json.loads(mav("vehicle", "check", "--json").out)["items"]
    assert {each["name"]: each["text"] for each in items}["home"] == "set"


@pytest.mark.parametrize("firmware", ["px4", "ardupilot"])
def test_the_check_of_a_fresh_connection_has_position_and_charge(mav, monkeypatch, firmware) -> None:
    CliHarness(monkeypatch, (VehicleType.COPTER, firmware), ready=True)
    items = json.loads(mav("vehicle", "check", "--json").out)["items"]
    states = {each["name"]: each["state"] for each in items}
    assert (states["position"], states["charge"], states["ready to arm"]) == ("ok", "ok", "ok")


def test_the_command(mav, monkeypatch) -> None:
    CliHarness(monkeypatch)
    assert mav("vehicle", "airframe").out == "vehicle 1: quad, X (FRAME_CLASS 1, FRAME_TYPE 1)\n"
    shown = mav("vehicle", "airframe", "3", "1", "--dry-run").out
    assert shown == "vehicle 1: sets FRAME_CLASS 3, FRAME_TYPE 1; nothing was sent\n"


def test_ports(mav, monkeypatch) -> None:
    harness = CliHarness(monkeypatch)
    assert mav("vehicle", "ports").out.splitlines()[0].split() == ["SERIAL0", "MAVLink", "2", "115200"]
    shown = mav("vehicle", "ports", "serial0", "--baud", "57600", "--json")
    assert json.loads(shown.out)["ports"][0]["baud"] == 57600
    assert harness.vehicle.parameters["SERIAL0_BAUD"] == 57
    result = mav("vehicle", "ports", "SERIAL77", "--baud", "57600")
    assert (result.code, result.err.count("\n")) == (1, 1)
    assert "there is no serial port SERIAL77" in result.err
