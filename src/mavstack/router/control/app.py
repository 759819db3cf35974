"""The control API of a router as an ASGI application; needs the extra `router`.

    GET    /endpoints                 the endpoints, with their counters
    POST   /endpoints                 add one: {"name": …, "url": …, …} with the keys of the configuration
    PATCH  /endpoints/NAME            change keys of one
    DELETE /endpoints/NAME            remove one
    POST   /endpoints/NAME/pause      and /resume
    GET    /routes                    learned addresses, and where they are
    POST   /reload                    read the configuration file again
    GET    /metrics                   for Prometheus

Each client that reaches the API controls the traffic. Beyond loopback it therefore needs a token, as
`Authorization: Bearer …`. Without a token a request must come from a program of this machine: one with an
`Origin`, which a page in a browser has, or with another host name, by which a page could reach loopback, is
refused, and the API opens only network links: no files, devices or sockets of the file system.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import asdict
from hmac import compare_digest
from typing import TYPE_CHECKING, Any

from mavstack.errors import (
    InvalidArgumentError,
    LinkError,
    LinkURLError,
    MavstackError,
    MissingExtraError,
    RouterConfigError,
)
from mavstack.http.bodies import RefusedError, read_json_object
from mavstack.http.web_origin import is_local_host
from mavstack.links import parse_url
from mavstack.links.client_urls import is_network_scheme, options_with_paths
from mavstack.router.config import endpoint_from_values
from mavstack.router.control.endpoint_values import values_of
from mavstack.router.snapshot import endpoint_values, take_snapshot

try:
    from starlette.applications import Starlette
    from starlette.responses import JSONResponse, Response
    from starlette.routing import Route
except ImportError as error:
    raise MissingExtraError("the control of the router", "router") from error

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from typing import TypeAlias

    from starlette.requests import Request

    from mavstack.router.config import EndpointConfig
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
        self._reload_file = reload
        routes = [
            Route("/endpoints", self._guard(self._list), methods=["GET"]),
            Route("/endpoints", self._guard(self._add), methods=["POST"]),
            Route("/endpoints/{name}", self._guard(self._change), methods=["PATCH"]),
            Route("/endpoints/{name}", self._guard(self._remove), methods=["DELETE"]),
            Route("/endpoints/{name}/pause", self._guard(self._pause), methods=["POST"]),
            Route("/endpoints/{name}/resume", self._guard(self._resume), methods=["POST"]),
            Route("/routes", self._guard(self._routes), methods=["GET"]),
            Route("/reload", self._guard(self._reload), methods=["POST"]),
        ]
        if metrics:
            from mavstack.router.control.metrics import RouterMetrics

            self._metrics = RouterMetrics(router)
            routes.append(Route("/metrics", self._guard(self._show_metrics), methods=["GET"]))
        self.app = Starlette(routes=routes)

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
            return
        if "origin" in request.headers or not is_local_host(request.headers.get("host", "")):
            raise RefusedError(403, "requests of web pages are refused: set control_token")

    async def _list(self, _: Request) -> Response:
        return JSONResponse([endpoint_values(each) for each in take_snapshot(self._router).endpoints])

    async def _routes(self, _: Request) -> Response:
        return JSONResponse([asdict(each) for each in take_snapshot(self._router).routes])

    async def _add(self, request: Request) -> Response:
        values = await read_json_object(request)
        name = values.pop("name", None)
        if not isinstance(name, str):
            raise RefusedError(400, "the name of the endpoint is missing")
        config = self._endpoint(name, values)
        await self._router.add(config)
        return JSONResponse({"name": name}, 201)

    async def _change(self, request: Request) -> Response:
        name = request.path_params["name"]
        present = self._present(name)
        config = self._endpoint(name, {**values_of(present), **await read_json_object(request)}, present)
        await self._router.change(config)
        return JSONResponse({"name": name})

    async def _remove(self, request: Request) -> Response:
        name = request.path_params["name"]
        self._present(name)
        await self._router.remove(name)
        return JSONResponse({"name": name})

    async def _pause(self, request: Request) -> Response:
        return await self._set_paused(request, paused=True)

    async def _resume(self, request: Request) -> Response:
        return await self._set_paused(request, paused=False)

    async def _set_paused(self, request: Request, *, paused: bool) -> Response:
        name = request.path_params["name"]
        self._present(name)
        await self._router.pause(name, paused=paused)
        return JSONResponse({"name": name, "pause": paused})

    async def _reload(self, _: Request) -> Response:
        if self._reload_file is None:
            raise RefusedError(409, "the router was started without a configuration file")
        return JSONResponse({"notes": list(await self._reload_file())})

    async def _show_metrics(self, _: Request) -> Response:
        return Response(self._metrics.text(), media_type="text/plain; version=0.0.4; charset=utf-8")

    def _present(self, name: str) -> EndpointConfig:
        found = self._router.config.endpoint(name)
        if found is None:
            raise RefusedError(404, f"there is no endpoint {name}")
        return found

    def _endpoint(
        self, name: str, values: dict[str, Any], present: EndpointConfig | None = None
    ) -> EndpointConfig:
        is_same = present is not None and values.get("url") == present.url
        if not self._token and not is_same:
            _refuse_paths(values.get("url"))
        config = endpoint_from_values(name, values, self._router.config.dialect)
        is_same = present is not None and (present.url, present.record) == (config.url, config.record)
        if not self._token and not is_same and not is_network_scheme(config.url.partition(":")[0]):
            raise RefusedError(403, "without control_token only network links can be opened")
        return config


def _refuse_paths(url: object) -> None:
    """Refuse a URL with an option that names a file, before the file is read."""
    with suppress(LinkURLError):  # it is reported with the place in the configuration
        if isinstance(url, str) and (named := options_with_paths(parse_url(url))):
            problem = "without control_token no file can be named"
            raise RefusedError(403, f"{problem}: leave out {', '.join(named)}")


def _problem(status: int, error: Exception) -> Response:
    return JSONResponse({"problem": str(error)}, status)
