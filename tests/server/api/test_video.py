from __future__ import annotations

import pytest

from tests.server.stations import COPTER, Ground, serve


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
