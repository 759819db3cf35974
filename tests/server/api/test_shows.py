"""The preview of shows."""

from __future__ import annotations

import pytest

from tests.server.stations import Ground, serve
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
