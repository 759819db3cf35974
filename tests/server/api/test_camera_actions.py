from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.server.api.camera_actions import ACTIONS
from tests.server.api.test_gimbals import with_payloads

if TYPE_CHECKING:
    from tests.server.asgi import ApiClient

CAMERA = "/api/vehicles/1/cameras/100"
#: In an order that a camera in photo mode accepts.
REQUESTS = {
    "photo": {},
    "photos/start": {"interval": 1, "count": 2},
    "photos/stop": {},
    "mode": {"mode": "video"},
    "video/start": {},
    "video/stop": {},
    "stream/start": {},
    "stream/stop": {},
    "zoom": {"value": 40},
    "focus": {"value": 30},
    "tracking/point": {"x": 0.4},
    "tracking/rectangle": {},
    "tracking/stop": {},
    "reset": {},
    "format": {},
}


def test_each_action_works_on_a_simulated_camera() -> None:
    async def scenario(api: ApiClient) -> None:
        assert REQUESTS.keys() == ACTIONS.keys()
        for name, body in REQUESTS.items():
            answer = await api.post(f"{CAMERA}/{name}", body)
            assert answer.status == 200, (name, answer.data)
            if name == "focus":
                (camera,) = (await api.get("/api/vehicles/1/cameras")).json
                assert (camera["status"]["zoom"], camera["status"]["focus"]) == (40, 30)
                assert camera["storages"][0]["total"] > 0

    with_payloads(scenario)


@pytest.mark.parametrize(
    ("name", "body"),
    [
        ("zoom", {"value": 140}),
        ("zoom", {"value": 1, "kind": "fast"}),
        ("focus", {"value": -3}),
        ("tracking/point", {"x": 2}),
        ("photos/start", {"interval": 0}),
        ("tracking/rectangle", {"left": 0.9, "right": 0.1}),
    ],
)
def test_values_that_no_camera_takes(name, body) -> None:
    async def scenario(api: ApiClient) -> None:
        assert (await api.post(f"{CAMERA}/{name}", body)).status == 400

    with_payloads(scenario)


def test_settings_with_their_options() -> None:
    async def scenario(api: ApiClient) -> None:
        settings = {each["name"]: each for each in (await api.get(f"{CAMERA}/settings")).json["settings"]}
        assert settings["CAM_MODE"]["options"] == {"Photo": 0, "Video": 1}
        assert not settings["CAM_VIDRES"]["available"]  # it takes photos
        answer = await api.put(f"{CAMERA}/settings/CAM_MODE", {"value": "Video"})
        changed = {each["name"]: each for each in answer.json["settings"]}
        assert (changed["CAM_MODE"]["value"], changed["CAM_VIDRES"]["available"]) == (1, True)
        assert (await api.put(f"{CAMERA}/settings/CAM_MODE", {"value": "Sleep"})).status == 400
        known = (await api.get(f"{CAMERA}/settings?cached=true")).json["settings"]
        assert known == answer.json["settings"]

    with_payloads(scenario)
