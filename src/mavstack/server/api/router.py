"""The state of a router of Mavstack that runs beside the station, by its control API."""

from __future__ import annotations

import asyncio
from typing import Any, Final

from mavstack.http.bodies import RefusedError
from mavstack.server.api_route import AnyRoute, ApiRoute, PlainCall


async def _show(call: PlainCall) -> dict[str, Any]:
    router = call.station.router
    if router is None:
        raise RefusedError(404, "the station was started without a router: mav web --router HOST:PORT")
    endpoints, routes = await asyncio.gather(
        asyncio.to_thread(router.endpoints), asyncio.to_thread(router.routes)
    )
    return {"endpoints": endpoints, "routes": routes}


ROUTES: Final[tuple[AnyRoute, ...]] = (
    ApiRoute(
        method="GET",
        path="/api/router",
        handler=_show,
        summary="Show the endpoints and the learned addresses of the router",
        tag="station",
        answer={
            "endpoints": [{"name": "ground", "state": "open"}],
            "routes": [{"system": 1, "component": 1}],
        },
    ),
)
