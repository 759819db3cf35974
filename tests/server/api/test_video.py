from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.server.api.video import MAX_OBSERVED
from tests.server.stations import COPTER, Ground, serve

if TYPE_CHECKING:
    from pathlib import Path

PASSWORDS = {Role.OBSERVE: "watching only", Role.OPERATE: "may fly it"}


def test_what_is_no_camera_is_refused() -> None:
    async def scenario(ground: Ground) -> None:
        shown = (await ground.api.get("/api/video")).json
        assert shown["viewers"] == 0
        for uri in ("file%3A%2F%2F%2Fetc%2Fpasswd", "concat%3Aa", ""):
            answer = await ground.api.post(f"/api/video/whep?uri={uri}")
            assert answer.status == 400
        answer = await ground.api.delete("/api/video/whep/none")
        assert (answer.status, answer.data) == (200, b'{"viewers":0}'), "it has left already"

    pytest.importorskip("aiortc")
    serve(COPTER, scenario)


def test_observers_watch_cameras_that_are_open(monkeypatch: pytest.MonkeyPatch) -> None:
    gateway = pytest.importorskip("mavstack.server.video.gateway")
    watched: list[object] = []

    async def watch(_self: object, address: object, _offer: str) -> None:
        watched.append(address)
        raise RefusedError(503, "the test opens no camera")

    monkeypatch.setattr(gateway.VideoGateway, "watch", watch)

    async def scenario(ground: Ground) -> None:
        async def status(role: Role) -> int:
            begun = await ground.api.post("/api/session", {"password": PASSWORDS[role]})
            ground.api.headers = {"authorization": f"Bearer {begun.json['token']}"}
            return (await ground.api.post("/api/video/whep?uri=rtsp%3A%2F%2F127.0.0.1%3A9%2Fa")).status

        assert await status(Role.OBSERVE) == 403
        assert watched == []
        assert await status(Role.OPERATE) == 503
        monkeypatch.setattr(gateway.VideoGateway, "plays", lambda _self, address: address == watched[0])
        assert await status(Role.OBSERVE) == 503
        assert len(watched) == 2
        monkeypatch.setattr(gateway.VideoGateway, "viewers", MAX_OBSERVED)
        assert await status(Role.OBSERVE) == 503
        assert len(watched) == 2, "the other places are for operators"
        assert await status(Role.OPERATE) == 503
        assert len(watched) == 3

    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))


def test_recorded_videos_are_listed_downloaded_and_ended_by_their_names(tmp_path: Path) -> None:
    pytest.importorskip("aiortc")

    async def scenario(ground: Ground) -> None:
        name = "copter-1-front-2026-11-28-101500.mp4"
        (tmp_path / name).write_bytes(b"pictures")
        (listed,) = (await ground.api.get("/api/video/recordings")).json
        assert (listed["name"], listed["size"], listed["running"]) == (name, 8, False)
        answer = await ground.api.get(f"/api/video/recordings/{name}")
        assert (answer.status, answer.data) == (200, b"pictures")
        for path in ("none.mp4", "..%2Fnone.mp4", "passwd"):
            assert (await ground.api.get(f"/api/video/recordings/{path}")).status == 404
        assert (await ground.api.post(f"/api/video/recordings/{name}/stop", {})).status == 404
        record = {"uri": "rtsp://127.0.0.1:9/a", "system": 1, "name": "Front"}
        answer = await ground.api.post("/api/video/recordings", record)
        assert (answer.status, answer.json["error"]["kind"]) == (409, "LinkError")
        for body in ({}, {"uri": "file:///etc/passwd"}, record | {"system": 0}):
            assert (await ground.api.post("/api/video/recordings", body)).status == 400

    serve(COPTER, scenario, folder=tmp_path)
    assert [each.name for each in tmp_path.iterdir()] == ["copter-1-front-2026-11-28-101500.mp4"]
