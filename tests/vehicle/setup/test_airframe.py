"""Airframes: read, planned with what they reset, changed."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.vehicle.setup import airframe
from tests.server.stations import COPTER, PX4_COPTER, Ground, serve

PLANE = (VehicleType.PLANE, Firmware.ARDUPILOT)
PATH = "/api/vehicles/1/airframe"


def test_ardupilot() -> None:
    async def scenario(ground: Ground) -> None:
        found = (await ground.api.get(PATH)).json
        assert {"number": 2, "name": "hexa"} in found.pop("airframes")
        assert {"number": 0, "name": "plus"} in found.pop("types")
        assert found == {"name": "quad, X", "values": {"FRAME_CLASS": 1, "FRAME_TYPE": 1}, "defined": True}
        planned = (await ground.api.put(PATH, {"airframe": 2, "dry_run": True})).json
        assert planned == {"sets": {"FRAME_CLASS": 2}, "resets": False, "keeps": [], "airframe": None}
        vehicle = ground.simulation.vehicles[0]
        assert vehicle.parameters["FRAME_CLASS"] == 1
        changed = (await ground.api.put(PATH, {"airframe": 2, "frame_type": 0})).json
        assert changed["airframe"]["name"] == "hexa, plus"
        assert (vehicle.parameters["FRAME_CLASS"], vehicle.boots) == (2, 2)

    serve(COPTER, scenario)


def test_px4_shows_what_is_reset() -> None:
    async def scenario(ground: Ground) -> None:
        found = (await ground.api.get(PATH)).json
        assert ({"number": 6001, "name": "hexacopter X"} in found["airframes"], found["types"]) == (True, [])
        planned = (await ground.api.put(PATH, {"airframe": 6001, "dry_run": True})).json
        assert planned["sets"] == {"SYS_AUTOSTART": 6001, "SYS_AUTOCONFIG": 1}
        assert planned["resets"]
        assert "CAL_*" in planned["keeps"]
        changed = (await ground.api.put(PATH, {"airframe": 6001, "reset": False})).json
        assert changed["airframe"]["name"] == "hexacopter X"
        assert ground.simulation.vehicles[0].parameters["SYS_AUTOSTART"] == 6001
        refused = await ground.api.put(PATH, {"airframe": 6001, "frame_type": 1})
        assert (refused.status, refused.problem) == (400, "PX4 has no frame type: the airframe is one number")

    serve(PX4_COPTER, scenario)


def test_an_armed_vehicle_keeps_its_airframe() -> None:
    async def scenario(ground: Ground) -> None:
        await ground.api.post("/api/vehicles/1/arm", {"force": True})
        refused = await ground.api.put(PATH, {"airframe": 2})
        assert refused.status == 409
        assert "it is armed; disarm it first" in refused.problem
        assert ground.simulation.vehicles[0].parameters["FRAME_CLASS"] == 1

    serve(COPTER, scenario)


def test_a_plane_of_ardupilot_has_no_frame_class() -> None:
    async def scenario(ground: Ground) -> None:
        refused = await ground.api.get(PATH)
        assert (refused.status, refused.kind) == (409, "ActionUnsupported")

    serve(PLANE, scenario)


def test_negative_numbers() -> None:
    class Vehicle:
        autopilot = 12

    with pytest.raises(InvalidArgumentError, match="0 or more, got -1"):
        airframe.plan_airframe(Vehicle(), -1)
