"""The swarm of a station."""

from __future__ import annotations

import asyncio

import pytest

from tests.server.stations import COPTER, PX4_COPTER, Ground, serve

pytestmark = pytest.mark.flight


def test_a_swarm_takes_off_flies_a_formation_moves_and_lands() -> None:
    async def scenario(ground: Ground) -> None:
        api = ground.api
        state = (await api.get("/api/swarm")).json
        assert (state["active"], state["members"], state["smallest_separation_m"]) == (False, [], None)
        launched = await api.post("/api/swarm/takeoff", {"altitude": 15, "layer_spacing": 15})
        assert launched.status == 200, launched.json
        answer = await api.post("/api/swarm/formation", {"shape": "line", "altitude": 15})
        assert answer.status == 200, answer.json
        state = answer.json
        assert (state["active"], state["leader"], state["systems"]) == (True, 1, [1, 2, 3])
        assert state["separation_m"] == pytest.approx(10.0, abs=1.0)
        assert all(each["follows"] and each["armed"] for each in state["members"])
        before = state["members"][0]["latitude"]
        moved = (await api.post("/api/swarm/move", {"north": 30})).json
        assert moved["members"][0]["latitude"] > before + 0.0002
        assert moved["smallest_separation_m"] > 5.0
        assert (await api.post("/api/swarm/rotate", {"degrees": 45})).json["course_deg"] == 45.0
        assert (await api.post("/api/swarm/move", {"east": 5, "lead": 2})).json["leader"] == 2
        landed = await api.post("/api/swarm/land")
        assert landed.status == 200, landed.json
        assert not landed.json["active"]
        assert landed.json["leader"] == 2  # a preview is drawn around it

    serve([COPTER, PX4_COPTER, COPTER], scenario)


def test_one_call_flies_at_a_time_and_stop_ends_it() -> None:
    async def scenario(ground: Ground) -> None:
        api = ground.api
        await api.post("/api/swarm/takeoff", {"altitude": 15, "layer_spacing": 15})
        flight = asyncio.create_task(api.post("/api/swarm/move", {"east": 200}))
        await asyncio.sleep(5)
        assert (await api.get("/api/swarm")).json["action"] == "move"
        busy = await api.post("/api/swarm/move", {"east": -10})
        assert busy.status == 409
        assert "busy (move)" in busy.json["error"]["text"]
        stopped = await api.post("/api/swarm/stop")
        assert stopped.status == 200
        assert not stopped.json["active"]
        ended = await flight
        assert ended.status == 409
        assert "stopped by a client" in ended.json["error"]["text"]
        assert {each["mode"] for each in stopped.json["members"]} == {"BRAKE"}

    serve([COPTER, COPTER], scenario)


def test_unknown_vehicles_and_shapes_are_refused() -> None:
    async def scenario(ground: Ground) -> None:
        api = ground.api
        assert (await api.post("/api/swarm/move", {"systems": [7]})).status == 404
        assert (await api.post("/api/swarm/formation", {"shape": "blob"})).status == 400
        assert (await api.post("/api/swarm/move", {"north": 5})).status == 409  # it is not armed
        assert (await api.delete("/api/swarm")).json["active"] is False

    serve(COPTER, scenario)


def test_slots_are_previewed_without_vehicles() -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.post("/api/swarm/preview", {"shape": "column", "spacing": 5, "count": 3})
        assert answer.json["slots"] == [[0, 0, 0], [-5, 0, 0], [-10, 0, 0]]
        assert "wedge" in (await ground.api.get("/api/swarm/formations")).json

    serve((), scenario)


def test_a_call_with_a_leader_alone_is_for_the_members_of_the_swarm() -> None:
    async def scenario(ground: Ground) -> None:
        api = ground.api
        await api.post("/api/swarm/takeoff", {"altitude": 15, "layer_spacing": 15})
        moved = await api.post("/api/swarm/move", {"systems": [1, 2], "north": 5})
        assert moved.json["systems"] == [1, 2]
        moved = await api.post("/api/swarm/move", {"lead": 2, "north": 5})
        assert (moved.json["systems"], moved.json["leader"]) == ([2, 1], 2)
        before = ground.station.connection.vehicles[3].mode
        stopped = await api.post("/api/swarm/stop", {"lead": 2})
        assert stopped.json["systems"] == [2, 1]
        assert ground.station.connection.vehicles[3].mode == before

    serve([COPTER, COPTER, COPTER], scenario)


@pytest.mark.nightly
def test_a_swarm_that_follows_a_leader_cannot_pause_on_its_way_to_the_formation_either() -> None:
    async def scenario(ground: Ground) -> None:
        api = ground.api
        await api.post("/api/swarm/takeoff", {"altitude": 15, "layer_spacing": 15})
        body = {"systems": [1, 2], "leader": 3, "shape": "line", "spacing": 15}
        flight = asyncio.create_task(api.post("/api/swarm/follow", body))
        await asyncio.sleep(3)
        refused = await api.post("/api/swarm/pause")
        assert (refused.status, "cannot pause" in refused.problem) == (400, True)
        await asyncio.sleep(30)
        assert (await api.post("/api/swarm/pause")).status == 400
        assert (await api.get("/api/swarm")).json["paused"] is False
        await api.post("/api/swarm/stop")
        assert (await flight).status == 409
        moving = asyncio.create_task(api.post("/api/swarm/move", {"systems": [1, 2], "north": 40}))
        await asyncio.sleep(3)
        assert (await api.post("/api/swarm/pause")).json["paused"] is True
        await api.post("/api/swarm/stop")
        await moving

    serve([COPTER, COPTER, COPTER], scenario)
