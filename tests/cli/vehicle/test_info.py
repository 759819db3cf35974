"""The page of `mav vehicle info`."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.vehicle.info import page, readiness
from tests.vehicle.world import ARDUPILOT, VehicleType

FACTS = {
    "system": 1,
    "type": "quadrotor",
    "firmware": "ArduPilot",
    "version": "4.6.0",
    "git_hash": None,
    "alive": True,
    "mode": "LOITER",
    "armed": False,
    "in_air": False,
    "status": "standby",
    "position": None,
    "ground_speed": None,
    "home": None,
    "home_distance": None,
    "batteries": [],
    "gps": None,
    "health": {"ready": None, "armed": False, "mode": None, "problems": [], "warnings": []},
    "components": [{"component": 100, "kind": "camera", "alive": True}],
    "features": {"mission": True, "calibrations": (), "cameras": (1, 100), "gimbals": (1,)},
    "board": None,
    "unique_id": None,
}


def test_payloads_of_the_autopilot_are_listed():
    lines = page(FACTS)
    assert [line.strip() for line in lines if "camera" in line or "gimbal" in line] == [
        "component  camera (100)",
        "attached   camera (1)",
        "gimbal (1)",
    ]


def test_a_rover_has_no_altitude_above_home(simulate, mav):
    simulate((VehicleType.ROVER, ARDUPILOT))
    shown = mav("vehicle", "info").out
    assert "m above sea" in shown
    assert "m above home" not in shown
    assert json.loads(mav("vehicle", "info", "--json").out)["position"]["relative_altitude"] is None


@pytest.mark.parametrize(
    ("ready", "armed", "text"),
    [
        (True, False, "ready to arm in mode LAND"),
        (True, True, "armed in mode LAND"),
        (False, True, "armed in mode LAND"),
        (False, False, "not ready to arm"),
        (None, None, "readiness to arm unknown"),
    ],
)
def test_an_armed_vehicle_is_not_ready_to_arm(ready, armed, text):
    assert readiness({"ready": ready, "armed": armed, "mode": "LAND"}) == text
