"""Simulated worlds of the station."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.server.worlds import MAX_WORLDS
from tests.server.stations import Ground, serve
from tests.simulators.firmwares import Sitl
from tests.simulators.test_firmware_session import SITL, options

FREE = {"firmware": "ardupilot", "vehicle": "rover", "listen": "udpin://127.0.0.1:0"}


def test_the_choices_of_a_world() -> None:
    async def scenario(ground: Ground) -> None:
        found = (await ground.api.get("/api/simulator-options")).json
        assert found["firmwares"] == ["px4", "ardupilot", "betaflight"]
        assert "gps-lost" in found["faults"]
        assert "copter" in found["physics"]
        assert "mujoco" not in found["physics"]  # its models are files of the machine
        assert found["programs"] == []

    serve([], scenario)


def test_a_world_is_started_paused_disturbed_and_stopped() -> None:
    async def scenario(ground: Ground) -> None:
        started = await ground.api.post("/api/simulators", FREE)
        assert (started.status, started.json["physics"], started.json["time"]) == (201, "rover", 0.0)
        path = f"/api/simulators/{started.json['id']}"
        sitl = await Sitl.connect(started.json["port"])
        await sitl.ask(0)
        paused = await ground.api.post(f"{path}/pace", {"paused": True, "speed": 2.0})
        assert (paused.json["paused"], paused.json["speed"]) == (True, 2.0)
        asking = asyncio.ensure_future(sitl.ask(1))
        await ground.api.post(f"{path}/pace", {"paused": False})
        await asking
        (listed,) = (await ground.api.get("/api/simulators")).json
        assert listed["lines"] == ["ArduPilot is connected"]
        broken = await ground.api.post(f"{path}/faults", {"fault": "gps-lost"})
        assert broken.json["faults"] == ["gps-lost"]
        mended = await ground.api.post(f"{path}/faults", {"fault": "gps-lost", "present": False})
        assert mended.json["faults"] == []
        assert (await ground.api.post(f"{path}/faults", {"fault": "bad luck"})).status == 400
        sitl.close()
        assert (await ground.api.delete(path)).status == 200
        assert (await ground.api.delete(path)).status == 404
        assert (await ground.api.get("/api/simulators")).json == []

    serve((), scenario)


def test_a_named_program_flies_and_becomes_a_source() -> None:
    made = options()

    async def scenario(ground: Ground) -> None:
        ground.station.worlds.programs["stand-in"] = SITL
        started = await ground.api.post(
            "/api/simulators", {**FREE, "program": "stand-in", "instance": made.instance}
        )
        assert started.status == 201
        assert started.json["source"] is not None
        await ground.wait_until(lambda: 1 in ground.station.connection.vehicles)
        stopped = await ground.api.delete(f"/api/simulators/{started.json['id']}")
        assert stopped.status == 200
        assert len((await ground.api.get("/api/sources")).json) == 1  # the simulated network of the test

    serve((), scenario)


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"firmware": "inav"}, 400),
        ({"physics": "os:system"}, 403),
        ({"physics": "mujoco:/etc/passwd"}, 403),
        ({"program": "/bin/sh"}, 403),
        ({"listen": "tcpin://127.0.0.1:0"}, 400),
        ({"speed": -1}, 400),
    ],
)
def test_wrong_worlds_are_refused(changes, status) -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.post("/api/simulators", FREE | changes)
        assert answer.status == status
        assert (await ground.api.get("/api/simulators")).json == []

    serve((), scenario)


def test_the_number_of_worlds_is_limited() -> None:
    async def scenario(ground: Ground) -> None:
        for _ in range(MAX_WORLDS):
            assert (await ground.api.post("/api/simulators", FREE)).status == 201
        assert (await ground.api.post("/api/simulators", FREE)).status == 409

    serve((), scenario)
