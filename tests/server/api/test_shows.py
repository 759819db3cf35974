"""The preview of shows, and their flight."""

from __future__ import annotations

import asyncio
from math import cos, radians, sin

import pytest

from mavstack.geodesy import LocalFrame
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.server.api import shows
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
        # The show is checked in a thread, which needs time that is not virtual.
        await ground.wait_until(lambda: ground.station.swarm.values()["active"])
        while (paused := await api.post("/api/swarm/pause")).status == 400:
            assert "on no way" in paused.problem
            await asyncio.sleep(0.1)
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


@pytest.mark.parametrize(("orientation", "bearing"), [(0.0, 270.0), (90.0, 0.0)])
@pytest.mark.flight_cases(1)
def test_a_show_is_turned_by_its_orientation(orientation: float, bearing: float) -> None:
    """The show ends 15 m to the left of its origin."""

    async def scenario(ground: Ground) -> None:
        launched = await ground.api.post("/api/swarm/takeoff", {"altitude": 10})
        origin = launched.json["members"][0]
        place = f"latitude={origin['latitude']}&longitude={origin['longitude']}"
        query = f"?systems=1&{place}&orientation={orientation}"
        ended = await ground.api.request("POST", f"/api/swarm/show{query}", data=skyc(1))
        assert ended.status == 200, ended.json
        frame = LocalFrame(origin["latitude"], origin["longitude"], 0.0)
        member = ended.json["members"][0]
        north, east, _ = frame.to_local(member["latitude"], member["longitude"], 0.0)
        turned = radians(bearing)
        assert (north, east) == pytest.approx((15.0 * cos(turned), 15.0 * sin(turned)), abs=1.5)

    serve(COPTER, scenario)


def test_a_show_that_is_too_long_to_be_checked_is_not_flown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shows, "MAX_CHECKED", 1499)

    async def scenario(ground: Ground) -> None:
        answer = await ground.api.request("POST", "/api/swarm/show?systems=1", data=skyc(1))
        assert answer.status == 400
        assert "a show of 1 vehicles and 60 s is too long to be flown by the station" in answer.problem
        assert (await ground.api.get("/api/swarm")).json["action"] is None

    serve(COPTER, scenario)


OBSERVED = [
    ("POST", "/api/shows?name=circle.skyc"),
    ("POST", "/api/swarm/show?name=circle.skyc&systems=1"),
    ("POST", "/api/swarm/pause"),
    ("POST", "/api/swarm/resume"),
    ("POST", "/api/swarm/stop"),
    ("POST", "/api/swarm/land"),
    ("POST", "/api/swarm/takeoff"),
    ("DELETE", "/api/swarm"),
    ("PUT", "/api/vehicles/1/files/collmot/show.skyb"),
]


def test_an_observer_starts_stops_and_uploads_no_shows() -> None:
    access = Access(passwords={Role.OBSERVE: "watching only", Role.ADMINISTER: "may do it all"})

    async def scenario(ground: Ground) -> None:
        api = ground.api
        for password, allowed in (("watching only", False), ("may do it all", True)):
            session = access.log_in("127.0.0.1", password=password).session
            api.headers = {"authorization": f"Bearer {session}"}
            assert (await api.get("/api/swarm")).status == 200
            for method, path in OBSERVED:
                body = skyc(1) if "show" in path else b""
                answer = await api.request(method, path, data=body)
                assert (answer.status != 403) is allowed, (path, answer.json)
            if not allowed:
                assert ground.simulation.vehicles[0].autopilot.armed is False

    serve(COPTER, scenario, access=access)
