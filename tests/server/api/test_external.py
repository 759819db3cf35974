from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.security.roles import Role
from mavstack.server.access import Access
from tests.server.api.test_actions import PASSWORDS
from tests.server.stations import COPTER, Ground, serve

if TYPE_CHECKING:
    from collections.abc import Iterable

PATH = "/api/vehicles/1/external"


def test_measurements_are_sent_and_reasons_named() -> None:
    async def scenario(ground: Ground) -> None:
        before = (await ground.api.get(PATH)).json
        assert (before["used"], before["sent"]) == (False, 0)
        assert any("VISO_TYPE is 0" in each for each in before["reasons"])
        assert not any("nothing was sent" in each for each in before["reasons"])
        pose = {"position": [1, 2, 3], "orientation": [1, 0, 0, 0], "frame": "NED", "body_frame": "FRD"}
        sent = await ground.api.post(f"{PATH}/odometry", {"values": pose})
        assert sent.json == {"kind": "odometry", "estimates": 1}
        assert (
            await ground.api.post(f"{PATH}/obstacles", {"values": {"distances": [3.0, None]}})
        ).status == 200
        target = {"latitude": 47.4, "longitude": 8.5, "altitude": 490}
        assert (await ground.api.post(f"{PATH}/follow-target", {"values": target})).status == 200

    serve(COPTER, scenario)


def test_impossible_measurements_are_refused() -> None:
    async def refused(ground: Ground, kind: str, values: Iterable[dict[str, object]]) -> None:
        for each in values:
            answer = await ground.api.post(f"{PATH}/{kind}", {"values": each})
            assert (answer.status, answer.kind) == (400, "InvalidArgumentError"), each

    async def scenario(ground: Ground) -> None:
        await refused(
            ground, "odometry", [{}, {"position": [1]}, {"position": "a"}, {"frame": 3}, {"time": "x"}]
        )
        await refused(ground, "distance", [{}, {"distance": -1}, {"distance": 1, "number": 10**6}])
        await refused(ground, "gps", [{"latitude": 99, "longitude": 0, "altitude": 0}])
        assert (await ground.api.post(f"{PATH}/radar", {"values": {}})).status in (404, 405)

    serve(COPTER, scenario)


def test_roles() -> None:
    async def scenario(ground: Ground) -> None:
        pose = {"values": {"position": [1, 2, 3]}}
        target = {"values": {"latitude": 47.4, "longitude": 8.5, "altitude": 490}}
        began = await ground.api.post("/api/session", {"password": PASSWORDS[Role.OPERATE]})
        headers = {"authorization": f"Bearer {began.json['token']}"}
        assert (await ground.api.post(f"{PATH}/vision", pose, headers=headers)).status == 403
        assert (await ground.api.post(f"{PATH}/follow-target", target, headers=headers)).status == 200

    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))
