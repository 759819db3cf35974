"""The preview of shows, and their flight."""

from __future__ import annotations

import asyncio

import pytest

from tests.server.stations import COPTER, PX4_COPTER, Ground, serve
from tests.swarm.shows.samples import csv_archive, skyc

pytestmark = pytest.mark.flight


def test_a_show_is_checked_and_its_tracks_are_returned() -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.request("POST", "/api/shows?name=circle.skyc", data=skyc())
        assert answer.status == 200, answer.json
        show = answer.json
        assert (show["name"], show["duration_s"], show["problems"]) == ("Circle", 60.0, [])
        assert show["separation_m"] > show["limit_m"]
        assert [each["name"] for each in show["tracks"]] == [f"Drone {number}" for number in (1, 2, 3, 4)]
        places = show["tracks"][1]["places"]  # a quarter to the left of the first one
        assert len(places) == 301
        assert places[0] == [0.0, -15.0, 0.0]
        assert places[100][2] == pytest.approx(10.0)
        assert (
            len(
                (await ground.api.request("POST", "/api/shows?name=t.zip", data=csv_archive())).json["tracks"]
            )
            == 3
        )

    serve((), scenario)


def test_limits_that_are_passed_are_named() -> None:
    async def scenario(ground: Ground) -> None:
        show = (await ground.api.request("POST", "/api/shows?speed=0.1", data=skyc(8, radius=5.0))).json
        assert any("apart" in each for each in show["problems"])
        assert any("speed over ground" in each for each in show["problems"])

    serve((), scenario)


def test_other_files_and_endless_shows_are_refused() -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.request("POST", "/api/shows?name=a.skyc", data=b"PK not an archive")
        assert answer.status == 400
        assert "ZIP archive" in answer.json["error"]["text"]
        answer = await ground.api.request("POST", "/api/shows", data=skyc(12, seconds=14_000.0))
        assert answer.status == 400
        assert "too long for a preview" in answer.json["error"]["text"]

    serve((), scenario)


SHOW = "/api/swarm/show?name=circle.skyc&systems=1,2,3"


def test_a_show_is_flown_pauses_and_ends() -> None:
    async def scenario(ground: Ground) -> None:
        api = ground.api
        assert (await api.post("/api/swarm/pause")).status == 409
        launched = await api.post("/api/swarm/takeoff", {"altitude": 10, "layer_spacing": 15})
        assert launched.status == 200, launched.json
        flight = asyncio.create_task(api.request("POST", f"{SHOW}&orientation=90", data=skyc(3)))
        await asyncio.sleep(10)
        busy = await api.request("POST", SHOW, data=skyc(3))
        assert (busy.status, "busy (show)" in busy.json["error"]["text"]) == (409, True)
        paused = await api.post("/api/swarm/pause")
        assert (paused.status, paused.json["paused"], paused.json["action"]) == (200, True, "show")
        await asyncio.sleep(6)
        before = (await api.get("/api/swarm")).json["members"]
        await asyncio.sleep(20)
        after = (await api.get("/api/swarm")).json["members"]
        for one, other in zip(before, after, strict=True):
            assert one["latitude"] == pytest.approx(other["latitude"], abs=5e-6)
            assert one["longitude"] == pytest.approx(other["longitude"], abs=5e-6)
        assert not flight.done()
        assert (await api.post("/api/swarm/resume")).json["paused"] is False
        ended = await flight
        assert ended.status == 200, ended.json
        assert ended.json["systems"] == [1, 2, 3]
        assert ended.json["smallest_separation_m"] > 5.0

    serve([COPTER, PX4_COPTER, COPTER], scenario)


@pytest.mark.parametrize(
    ("query", "status", "words"),
    [
        ("?name=circle.skyc", 400, "systems"),
        ("?systems=1,x", 400, "systems"),
        ("?systems=1,9", 404, "no vehicle with system id 9"),
        ("?systems=1&latitude=47", 400, "latitude and longitude"),
        ("?systems=1", 409, "not armed"),
    ],
    ids=["no vehicles", "no numbers", "an unknown one", "half an origin", "on the ground"],
)
def test_flights_of_shows_are_refused(query: str, status: int, words: str) -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.request("POST", f"/api/swarm/show{query}", data=skyc(1))
        assert (answer.status, words in answer.json["error"]["text"]) == (status, True), answer.json

    serve(COPTER, scenario)
