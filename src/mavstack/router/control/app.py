"""The control API of a router as an ASGI application; needs the extra `router`.

    GET    /endpoints                 the endpoints, with their counters
    POST   /endpoints                 add one: {"name": …, "url": …, …} with the keys of the configuration
    PATCH  /endpoints/NAME            change keys of one
    DELETE /endpoints/NAME            remove one
    POST   /endpoints/NAME/pause      and /resume
    GET    /routes                    learned addresses, and where they are
    POST   /reload                    read the configuration file again
    GET    /openapi.json              the description of these requests
    GET    /metrics                   for Prometheus

Each client that reaches the API controls the traffic. Beyond loopback it therefore needs a token, as
`Authorization: Bearer …`. Without a token a request must come from a program of this machine: one with an
`Origin`, which a page in a browser has, or with another host name, by which a page could reach loopback, is
refused, and the API opens only network links: no files, devices or sockets of the file system.
"""

from __future__ import annotations

from hmac import compare_digest
from typing import TYPE_CHECKING, Any

from mavstack.errors import (
    InvalidArgumentError,
    LinkError,
    MavstackError,
    MissingExtraError,
    RouterConfigError,
)
from mavstack.http.bodies import RefusedError, read_json_object
from mavstack.http.web_origin import is_local_host
from mavstack.security.admission import Proof

try:
    from msgspec import to_builtins
    from starlette.applications import Starlette
    from starlette.responses import JSONResponse, Response
    from starlette.routing import Route

    from mavstack.http.connections import mark_client
    from mavstack.http.openapi import describe
    from mavstack.http.request_fields import read_fields
except ImportError as error:
    raise MissingExtraError("the control of the router", "router") from error

from mavstack.router.control.routes import API, ROUTES, ControlCall

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from typing import TypeAlias

    from starlette.requests import Request

    from mavstack.router.control.routes import ControlRoute
    from mavstack.router.router import Router

    Handler: TypeAlias = Callable[[Request], Awaitable[Response]]


class ControlApi:
    """The API of one router.

    Args:
        router: The open router.
        token: The token that clients show; empty: only programs of this machine are served.
        reload: Reads the configuration file again, and returns notes; None: there is no file.
        metrics: Serve `/metrics`.
    """

    def __init__(
        self,
        router: Router,
        *,
        token: str = "",
        reload: Callable[[], Awaitable[tuple[str, ...]]] | None = None,
        metrics: bool = True,
    ) -> None:
        self._router = router
        self._token = token
        self._reload = reload
        routes = [Route(each.path, self._answering(each), methods=[each.method]) for each in ROUTES]
        routes.append(Route("/openapi.json", self._guard(_describe), methods=["GET"]))
        if metrics:
            from mavstack.router.control.metrics import RouterMetrics

            self._metrics = RouterMetrics(router)
            routes.append(Route("/metrics", self._guard(self._show_metrics), methods=["GET"]))
        self.app = Starlette(routes=routes)

    def _answering(self, route: ControlRoute[Any]) -> Handler:
        """Return the function of a route that Starlette calls."""

        async def answer(request: Request) -> Response:
            body = None if route.body is None else read_fields(route.body, await read_json_object(request))
            call = ControlCall(
                router=self._router,
                name=request.path_params.get("name", ""),
                body=body,
                is_trusted=bool(self._token),
                reload=self._reload,
            )
            return JSONResponse(to_builtins(await route.handler(call)), route.status)

        return self._guard(answer)

    def _guard(self, handler: Handler) -> Handler:
        """Return a handler that refuses strangers, and reports errors as JSON."""

        async def guarded(request: Request) -> Response:
            try:
                self._check(request)
                return await handler(request)
            except RefusedError as error:
                return _problem(error.status, error)
            except (InvalidArgumentError, RouterConfigError) as error:
                return _problem(400, error)
            except LinkError as error:
                return _problem(409, error)
            except MavstackError as error:
                return _problem(500, error)

        return guarded

    def _check(self, request: Request) -> None:
        if self._token:
            scheme, _, shown = request.headers.get("authorization", "").partition(" ")
            if scheme.lower() != "bearer" or not compare_digest(shown.strip().encode(), self._token.encode()):
                raise RefusedError(401, "a valid token is needed: Authorization: Bearer …")
            # authenticated: clients without a token cannot take this connection's place
            mark_client(Proof.AUTHENTICATED, "token")
            return
        if "origin" in request.headers or not is_local_host(request.headers.get("host", "")):
            raise RefusedError(403, "requests of web pages are refused: set control_token")

    async def _show_metrics(self, _: Request) -> Response:
        return Response(self._metrics.text(), media_type="text/plain; version=0.0.4; charset=utf-8")


async def _describe(_: Request) -> Response:
    return JSONResponse(describe(ROUTES, API))


def _problem(status: int, error: Exception) -> Response:
    return JSONResponse({"problem": str(error)}, status)
