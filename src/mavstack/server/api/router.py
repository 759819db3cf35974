"""The state of a router of Mavstack that runs beside the station, by its control API."""

from __future__ import annotations

import asyncio
from typing import Any, Final

from mavstack.http.bodies import RefusedError
from mavstack.http.routes import RouteTable
from mavstack.server.api_route import AnyRoute, ApiRoute, PlainCall

ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "station")


@ROUTES.add(
    "GET",
    "/api/router",
    "Show the endpoints and the learned addresses of the router",
    answer={
        "endpoints": [{"name": "ground", "state": "open"}],
        "routes": [{"system": 1, "component": 1}],
    },
)
async def _show(call: PlainCall) -> dict[str, Any]:
    router = call.station.router
    if router is None:
        raise RefusedError(404, "the station was started without a router: mav web --router HOST:PORT")
    endpoints, routes = await asyncio.gather(
        asyncio.to_thread(router.endpoints), asyncio.to_thread(router.routes)
    )
    return {"endpoints": endpoints, "routes": routes}
