"""The ASGI application of the station: pages, API, WebSockets; needs the extra `web`.

GET /               the page of the station        GET /openapi.json   the description of the API
GET /api/…          see `mavstack.server.api`      WS  /ws             see `mavstack.server.websockets`
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MavstackError, MissingExtraError

try:
    from starlette.applications import Starlette
    from starlette.exceptions import HTTPException
    from starlette.middleware.cors import CORSMiddleware
    from starlette.requests import ClientDisconnect, Request
    from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response
    from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
except ImportError as error:
    raise MissingExtraError("the ground station", "web") from error

from mavstack.http.bodies import RefusedError
from mavstack.http.openapi import describe
from mavstack.http.routes import Route as DescribedRoute
from mavstack.server.api import (
    actions,
    calibrations,
    cameras,
    conflicts,
    equipment,
    extended_parameters,
    external,
    files,
    firmware,
    generator,
    gimbals,
    maps,
    messages,
    parameters,
    part_calls,
    plans,
    recordings,
    router,
    shows,
    simulators,
    station,
    surveys,
    swarms,
    vehicle_setup,
    vehicles,
    video,
)
from mavstack.server.api.session import LogIn, Sessions
from mavstack.server.description import API
from mavstack.server.dispatch import endpoint_of, problem_response
from mavstack.server.latest_answers import LatestAnswers
from mavstack.server.page_files import PageFiles
from mavstack.server.websockets import websocket_endpoint

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable, Mapping, MutableMapping

    from starlette.types import ASGIApp, Receive, Scope, Send

    from mavstack.http.early_answers import EarlyAnswer
    from mavstack.server.access import Access
    from mavstack.server.api_route import AnyRoute
    from mavstack.server.station import Station

#: The built pages, from the sources in `web/`.
STATIC: Final = Path(__file__).parent / "static"
NOT_BUILT: Final = (
    "The pages of the ground station are not built: run `make station` in the source tree, with Node. "
    "The API works without them; /openapi.json describes it.\n"
)
#: Content security policy of the pages: scripts only from the station; map tiles and videos from any server.
POLICY: Final = (
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob: https: http:; media-src 'self' blob: https: http:; "
    "connect-src 'self' ws: wss: https: http:; worker-src 'self'; frame-ancestors 'none'; "
    "object-src 'none'; base-uri 'none'; form-action 'self'"
)
#: Content security policy of the worker that runs the script of a dashboard: the script can request nothing.
#: The sandbox has no origin, so the script has no access to the storage and the devices of the pages.
SCRIPT_POLICY: Final = "default-src 'none'; script-src 'unsafe-eval'; sandbox allow-scripts"
#: The folder of the files that are sent with `SCRIPT_POLICY`; `web/vite.config.ts` has the same name.
SCRIPT_FOLDER: Final = "/sandbox"
_HEADERS: Final = {
    b"content-security-policy": POLICY.encode(),
    b"x-content-type-options": b"nosniff",
    b"referrer-policy": b"no-referrer",
    b"cross-origin-resource-policy": b"same-origin",
    b"cross-origin-opener-policy": b"same-origin",
}

#: All API routes that are checked and described by this table; the first matching route is used.
ROUTES: Final[tuple[AnyRoute, ...]] = (
    *vehicles.ROUTES,
    *conflicts.ROUTES,
    *messages.ROUTES,
    *actions.ROUTES,
    *equipment.ROUTES,
    *part_calls.ROUTES,
    *external.ROUTES,
    *calibrations.ROUTES,
    *cameras.ROUTES,
    *gimbals.ROUTES,
    *parameters.ROUTES,
    *extended_parameters.ROUTES,
    *vehicle_setup.ROUTES,
    *plans.ROUTES,
    *surveys.ROUTES,
    *swarms.ROUTES,
    *shows.ROUTES,
    *files.ROUTES,
    *station.ROUTES,
    *recordings.ROUTES,
    *router.ROUTES,
    *simulators.ROUTES,
    *firmware.ROUTES,
    *generator.ROUTES,
    *maps.ROUTES,
    *video.ROUTES,
)


def describe_station() -> dict[str, Any]:
    """Return the OpenAPI document of the station's API."""
    described = [replace(each, about=f"Needs the role {each.role.word}.") for each in ROUTES]
    return describe((*described, *_session_routes()), API)


def make_app(
    ground: Station, access: Access, *, secure: bool = False, static: Path | None = STATIC
) -> Starlette:
    """Return the application of a station.

    Args:
        ground: The station, open while the application serves.
        access: The decision on its clients.
        secure: True if it is served with TLS only, so that cookies are too.
        static: The folder of the pages; None: there are none.

    Returns:
        The ASGI application.
    """
    sessions = Sessions(access, secure=secure)
    description = describe_station()

    async def openapi(request: Request) -> Response:
        access.check_page(request.headers)
        return JSONResponse(description)

    routes: list[BaseRoute] = [
        *(Route(each.path, endpoint_of(each, ground, access), methods=[each.method]) for each in ROUTES),
        Route("/api/session", _guarded(sessions.begin), methods=["POST"]),
        Route("/api/session", _guarded(sessions.show), methods=["GET"]),
        Route("/api/session", _guarded(sessions.end), methods=["DELETE"]),
        Route("/openapi.json", _guarded(openapi), methods=["GET"]),
        WebSocketRoute("/ws", websocket_endpoint(ground, access)),
        Route("/ws", _guarded(_not_upgraded), methods=["GET"]),
        *_other_methods(description["paths"]),
        *_page_routes(access, static),
    ]
    app = Starlette(routes=routes, exception_handlers={HTTPException: _unknown_route})
    if access.origins:  # otherwise a browser hides the answers from pages of these origins
        app.add_middleware(
            CORSMiddleware,
            allow_origins=sorted(access.origins),
            allow_methods=["GET", "POST", "PUT", "DELETE"],
            allow_headers=["Authorization", "Content-Type"],
        )
    app.add_middleware(_SecurityHeaders)
    return app


def make_early_answers(ground: Station, access: Access) -> EarlyAnswer:
    """Return the function that answers frequent requests of a station by their heads alone."""
    return LatestAnswers(ground, access, _HEADERS.items()).answer


class _SecurityHeaders:
    """Adds the headers that limit what a page may do, unless an answer has its own."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_with_headers(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                present = {name for name, _ in message["headers"]}
                missing = [(name, value) for name, value in _HEADERS.items() if name not in present]
                message["headers"] = [*message["headers"], *missing]
            await send(message)

        await self._app(scope, receive, send_with_headers)


def _page_routes(access: Access, static: Path | None) -> list[BaseRoute]:
    async def page(request: Request) -> Response:
        access.check_page(request.headers)
        index = None if static is None else static / "index.html"
        if index is None or not index.is_file():
            return PlainTextResponse(NOT_BUILT, 503)
        return FileResponse(index, headers={"Cache-Control": "no-cache"})

    routes: list[BaseRoute] = [Route("/", _guarded(page), methods=["GET"])]
    if static is not None and static.is_dir():
        policy = {"Content-Security-Policy": SCRIPT_POLICY}
        routes.append(Mount(SCRIPT_FOLDER, PageFiles(static / SCRIPT_FOLDER.strip("/"), policy)))
        routes.append(Mount("/", PageFiles(static)))
    return routes


def _guarded(handler: Callable[[Request], Awaitable[Response]]) -> Callable[[Request], Awaitable[Response]]:
    async def guarded(request: Request) -> Response:
        try:
            return await handler(request)
        except (RefusedError, MavstackError) as error:
            return problem_response(error)
        except ClientDisconnect:  # the client left during its request, so no client reads the answer
            return Response(status_code=400)

    return guarded


async def _not_upgraded(_: Request) -> Response:
    """Refuse a request that is no WebSocket."""
    response = problem_response(RefusedError(426, "/ws is a WebSocket: send the request with an upgrade"))
    response.headers.update({"Upgrade": "websocket", "Connection": "Upgrade"})
    return response


async def _unknown_route(request: Request, error: Exception) -> Response:
    status = error.status_code if isinstance(error, HTTPException) else 500
    headers = error.headers if isinstance(error, HTTPException) else None
    reason = "does not exist" if status == 404 else f"does not take {request.method}"
    response = problem_response(RefusedError(status, f"{request.url.path[:200]} {reason}"))
    response.headers.update(headers or {})
    return response


class _OtherMethods:
    """Refuses the methods that a path does not take; without it the pages would answer that it is unknown.

    Starlette would name the methods of one route of the path only.
    """

    def __init__(self, methods: Iterable[str]) -> None:
        self._headers = {"Allow": ", ".join(sorted(methods))}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        response = await _unknown_route(Request(scope), HTTPException(405, headers=self._headers))
        await response(scope, receive, send)


def _other_methods(paths: Mapping[str, Mapping[str, object]]) -> list[BaseRoute]:
    """Return the routes of all methods that a description does not have."""
    return [
        Route(path.replace("{path}", "{path:path}"), _OtherMethods(map(str.upper, methods)))
        for path, methods in paths.items()
    ]


def _session_routes() -> tuple[DescribedRoute[Any, Any], ...]:
    begun = {"role": "operate", "needs_password": True, "ticket": "v2|…", "token": "…"}
    shown = {"role": "operate", "needs_password": True, "ticket": "v2|…"}
    place, tag = "/api/session", "session"
    return (
        DescribedRoute(
            method="POST",
            path=place,
            summary="Begin a session",
            tag=tag,
            body=LogIn,
            status=201,
            answer=begun,
        ),
        DescribedRoute(
            method="GET",
            path=place,
            summary="Show the role, with a ticket for a WebSocket",
            tag=tag,
            answer=shown,
        ),
        DescribedRoute(
            method="DELETE",
            path=place,
            summary="End the session",
            tag=tag,
            answer={"role": None},
        ),
    )
