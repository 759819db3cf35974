"""The routes of the control API with their handlers."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final, Generic

from msgspec import Meta, Struct, to_builtins

from mavstack.errors import LinkURLError
from mavstack.http.bodies import RefusedError
from mavstack.http.openapi import Api
from mavstack.http.routes import BodyT, Route, RouteTable
from mavstack.links import parse_url
from mavstack.links.client_urls import is_network_scheme, options_with_paths
from mavstack.router.config import endpoint_from_values
from mavstack.router.control.endpoint_values import values_of
from mavstack.router.control.requests import AddEndpoint, ChangeEndpoint
from mavstack.router.snapshot import endpoint_values, take_snapshot

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.router.config import EndpointConfig
    from mavstack.router.router import Router


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlCall(Generic[BodyT]):
    """A request that was checked, for its handler.

    Attributes:
        router: The router.
        name: The endpoint that the path names; empty: none.
        body: The fields of the JSON body, or None.
        is_trusted: True if the client showed a token: it may open files and devices too.
        reload: Reads the configuration file again, and returns notes; None: there is no file.
    """

    router: Router
    name: str
    body: BodyT
    is_trusted: bool
    reload: Callable[[], Awaitable[tuple[str, ...]]] | None

    @property
    def endpoint(self) -> EndpointConfig:
        """The endpoint that the path names; raises `RefusedError` if there is none."""
        found = self.router.config.endpoint(self.name)
        if found is None:
            raise RefusedError(404, f"there is no endpoint {self.name}")
        return found


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlRoute(Route[BodyT, None]):
    """A route with its handler, which returns the JSON of the answer."""

    handler: Callable[[ControlCall[BodyT]], Awaitable[Any]]


class Changed(Struct):
    """The endpoint that was added, changed or removed."""

    name: str


class Paused(Struct):
    """The endpoint that was paused, or continues."""

    name: str
    pause: bool


class Reloaded(Struct):
    """Notes about changes of the file that need a restart."""

    notes: tuple[str, ...]


class Problem(Struct):
    """The answer to a request that is refused or fails."""

    problem: Annotated[str, Meta(description="The error in words.")]


API: Final = Api(
    title="Mavstack router",
    version="1.0",
    about="The control API of a router: its endpoints, its learned addresses and its configuration file.",
    path_parts={
        "name": {"description": "The name of an endpoint.", "schema": {"type": "string"}, "example": "ground"}
    },
    error=Problem,
    errors=(400, 401, 403, 404, 409, 413, 415, 500),
    security={"token": {"type": "http", "scheme": "bearer"}},
)


_ONE: Final = "/endpoints/{name}"
_CHANGED: Final = {"name": "ground"}
ROUTES: Final[RouteTable[ControlRoute[Any]]] = RouteTable(ControlRoute, "endpoints")


@ROUTES.add(
    "GET",
    "/endpoints",
    "List the endpoints, with their counters",
    answer=[{"name": "ground", "state": "open"}],
)
async def _list(call: ControlCall[None]) -> list[dict[str, Any]]:
    return [endpoint_values(each) for each in take_snapshot(call.router).endpoints]


@ROUTES.add(
    "GET",
    "/routes",
    "List the learned addresses, and where they are",
    tag="router",
    answer=[{"system": 1, "component": 1, "endpoints": ["ground"]}],
)
async def _list_addresses(call: ControlCall[None]) -> list[dict[str, Any]]:
    return [asdict(each) for each in take_snapshot(call.router).routes]


@ROUTES.add("POST", "/endpoints", "Add an endpoint", status=201, answer=_CHANGED, answer_model=Changed)
async def _add(call: ControlCall[AddEndpoint]) -> Changed:
    values = to_builtins(call.body)
    name = values.pop("name")
    await call.router.add(_config(call, name, values))
    return Changed(name)


@ROUTES.add("PATCH", _ONE, "Change keys of an endpoint", answer=_CHANGED, answer_model=Changed)
async def _change(call: ControlCall[ChangeEndpoint]) -> Changed:
    present = call.endpoint
    values = {**values_of(present), **to_builtins(call.body)}
    await call.router.change(_config(call, call.name, values, present))
    return Changed(call.name)


@ROUTES.add("DELETE", _ONE, "Remove an endpoint", answer=_CHANGED, answer_model=Changed)
async def _remove(call: ControlCall[None]) -> Changed:
    await call.router.remove(call.endpoint.name)
    return Changed(call.name)


@ROUTES.add(
    "POST",
    f"{_ONE}/pause",
    "Pause an endpoint",
    answer={"name": "ground", "pause": True},
    answer_model=Paused,
)
async def _pause(call: ControlCall[None]) -> Paused:
    await call.router.pause(call.endpoint.name, paused=True)
    return Paused(call.name, pause=True)


@ROUTES.add(
    "POST",
    f"{_ONE}/resume",
    "Let an endpoint continue",
    answer={"name": "ground", "pause": False},
    answer_model=Paused,
)
async def _resume(call: ControlCall[None]) -> Paused:
    await call.router.pause(call.endpoint.name, paused=False)
    return Paused(call.name, pause=False)


@ROUTES.add(
    "POST",
    "/reload",
    "Read the configuration file again",
    tag="router",
    answer={"notes": []},
    answer_model=Reloaded,
)
async def _reload(call: ControlCall[None]) -> Reloaded:
    if call.reload is None:
        raise RefusedError(409, "the router was started without a configuration file")
    return Reloaded(tuple(await call.reload()))


def _config(
    call: ControlCall[Any], name: str, values: dict[str, Any], present: EndpointConfig | None = None
) -> EndpointConfig:
    """Return the endpoint; a client without a token opens only network links, and names no files."""
    is_same = present is not None and values.get("url") == present.url
    if not call.is_trusted and not is_same:
        _refuse_paths(values.get("url"))
    config = endpoint_from_values(name, values, call.router.config.dialect)
    is_same = present is not None and (present.url, present.record) == (config.url, config.record)
    if not call.is_trusted and not is_same and not is_network_scheme(config.url.partition(":")[0]):
        raise RefusedError(403, "without control_token only network links can be opened")
    return config


def _refuse_paths(url: object) -> None:
    """Refuse a URL with an option that names a file, before the file is read."""
    with suppress(LinkURLError):  # an invalid URL is reported later, with its place in the configuration
        if isinstance(url, str) and (named := options_with_paths(parse_url(url))):
            problem = "without control_token no file can be named"
            raise RefusedError(403, f"{problem}: leave out {', '.join(named)}")
