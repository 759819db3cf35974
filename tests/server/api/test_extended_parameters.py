from __future__ import annotations

from typing import TYPE_CHECKING

from tests.server.api.test_gimbals import with_payloads

if TYPE_CHECKING:
    from tests.server.asgi import ApiClient

PARAMETERS = "/api/vehicles/1/components/100/extended-parameters"


def test_extended_parameters_are_listed_and_set() -> None:
    async def scenario(api: ApiClient) -> None:
        listed = {each["name"]: each for each in (await api.get(PARAMETERS)).json["parameters"]}
        assert listed["CAM_MODE"] == {"name": "CAM_MODE", "value": 0, "type": "UINT32"}
        changed = await api.put(f"{PARAMETERS}/CAM_MODE", {"value": 1})
        assert changed.json["value"] == 1
        assert (await api.put(f"{PARAMETERS}/NO_SUCH", {"value": 1})).status in (409, 504)
        assert (await api.get("/api/vehicles/1/components/0/extended-parameters")).status == 404

    with_payloads(scenario)
