"""Surveys and searches that a station plans."""

from __future__ import annotations

import pytest

from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.server.stations import COPTER, Ground, serve

OUTLINE = [[47.3970, 8.5450], [47.3970, 8.5463], [47.3988, 8.5463], [47.3988, 8.5450]]


def test_a_survey_is_divided_among_vehicles_and_uploaded() -> None:
    async def scenario(ground: Ground) -> None:
        request = {"outline": OUTLINE, "spacing": 20, "speed": 5, "vehicles": [{"system": 1}, {"speed": 10}]}
        answer = await ground.api.post("/api/surveys", request)
        assert answer.status == 200, answer.json
        own, other = answer.json["shares"]
        assert (own["system"], other["system"]) == (1, None)
        assert other["length_m"] == pytest.approx(2 * own["length_m"], rel=0.01)
        assert own["duration_s"] == pytest.approx(own["way_m"] / 5, abs=0.1)
        assert answer.json["area_m2"] == pytest.approx(200.2 * 98.0, rel=0.01)
        assert len(own["legs"][0]) == 2
        plan = {"fileType": "MavstackPlan", "version": 1, "home": None, "mission": own["items"]}
        uploaded = await ground.api.put("/api/vehicles/1/mission", plan)
        assert uploaded.status == 200, uploaded.json

    serve(COPTER, scenario)


def test_a_camera_gives_spacing_and_pictures_and_a_corridor_follows_its_route() -> None:
    async def scenario(ground: Ground) -> None:
        request = {"route": OUTLINE[:3], "width": 60, "altitude": 50, "camera": {"width": 4000}}
        answer = await ground.api.post("/api/surveys", request)
        assert answer.json["bearing_deg"] is None
        assert answer.json["spacing_m"] == pytest.approx(answer.json["footprint_m"][0] * 0.3, abs=0.001)
        assert answer.json["pixel_m"] == pytest.approx(0.01874, abs=0.0001)
        names = [item["name"] for item in answer.json["shares"][0]["items"]]
        assert "DO_SET_CAM_TRIGG_DIST" in names
        assert len(answer.json["shares"][0]["legs"]) == 6  # three tracks of two legs

    serve((), scenario)


def test_a_search_begins_where_its_vehicle_is() -> None:
    async def scenario(ground: Ground) -> None:
        vehicle = ground.station.connection.vehicles[1]
        await ground.wait_until(lambda: vehicle.position)
        position = vehicle.position
        center = [position.latitude + 0.002, position.longitude]
        request = {"pattern": "square", "center": center, "vehicles": [{"system": 1}]}
        answer = await ground.api.post("/api/searches", request)
        assert answer.status == 200, answer.json
        assert answer.json["shares"][0]["legs"][0][0] == pytest.approx(center)

    serve(COPTER, scenario, full_telemetry=True)


def test_a_duration_without_a_speed_is_that_of_the_vehicles_type() -> None:
    async def scenario(ground: Ground) -> None:
        vehicles = [{"system": 1}, {"system": 2}, {}, {"system": 1, "speed": 8}]
        survey = {"outline": OUTLINE, "vehicles": vehicles}
        search = {"center": OUTLINE[0], "vehicles": vehicles}
        for path, body in (("/api/surveys", survey), ("/api/searches", search)):
            shares = (await ground.api.post(path, body)).json["shares"]
            assert [each["speed_m_s"] for each in shares] == [5.0, 15.0, 5.0, 8.0]
            for each in shares:
                assert each["duration_s"] == pytest.approx(each["way_m"] / each["speed_m_s"], abs=0.1)
            assert shares[1]["length_m"] == pytest.approx(3 * shares[0]["length_m"], rel=0.01)
            shares = (await ground.api.post(path, body | {"speed": 4})).json["shares"]
            assert [each["speed_m_s"] for each in shares] == [4.0] * 4

    serve([COPTER, (VehicleType.PLANE, Firmware.ARDUPILOT)], scenario)


@pytest.mark.parametrize(
    "request_body",
    [
        {},
        {"outline": OUTLINE, "route": OUTLINE},
        {"outline": OUTLINE[:2]},
        {"outline": OUTLINE, "spacing": 0.001},
        {"outline": OUTLINE, "side_overlap": 1},
        {"outline": [[91, 8], *OUTLINE]},
        {"outline": OUTLINE, "vehicles": []},
        {"outline": OUTLINE, "division": "grid", "spacing": 500, "vehicles": [{}, {}]},
    ],
)
def test_impossible_surveys_are_refused(request_body) -> None:
    async def scenario(ground: Ground) -> None:
        assert (await ground.api.post("/api/surveys", request_body)).status == 400

    serve((), scenario)
