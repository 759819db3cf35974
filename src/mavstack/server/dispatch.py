"""From a request to its answer: the checks that all routes share, the handler, and errors as JSON."""

from __future__ import annotations

import logging
from contextlib import AbstractContextManager, ExitStack, asynccontextmanager, nullcontext
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from starlette.requests import ClientDisconnect
from starlette.responses import JSONResponse, Response

from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError, read_bytes, read_json_object
from mavstack.http.connections import mark_client
from mavstack.server.api.events import EventStream
from mavstack.server.api_route import Call
from mavstack.server.fields import read_fields, read_query
from mavstack.server.json_values import to_json
from mavstack.server.problems import problem_json, status_of
from mavstack.server.session_end import ending_with_session

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from starlette.requests import Request

    from mavstack.server.access import Access, Client
    from mavstack.server.api_route import ApiRoute
    from mavstack.server.station import Station
    from mavstack.server.tasks import Task

logger = logging.getLogger("mavstack.server")


def endpoint_of(
    route: ApiRoute, station: Station, access: Access
) -> Callable[[Request], Awaitable[Response]]:
    """Return the function of a route that Starlette calls."""

    async def endpoint(request: Request) -> Response:
        try:
            return await _answer(route, station, access, request)
        except (RefusedError, MavstackError) as error:
            return problem_response(error)
        except ClientDisconnect:  # in the middle of its request: no client reads the answer
            return Response(status_code=400)
        except Exception as error:
            logger.exception("%s %s failed", route.method, route.path)
            return problem_response(error)

    return endpoint


def problem_response(error: Exception) -> Response:
    """Return the answer to a request that ended in an error."""
    status = status_of(error)
    headers = {"WWW-Authenticate": "Bearer"} if status == 401 else None
    return JSONResponse(problem_json(error), status, headers)


async def _answer(route: ApiRoute, station: Station, access: Access, request: Request) -> Response:
    client = access.check_request(request)
    mark_client(request.scope, client.proof, client.holder)
    call = Call(station=station, request=request, role=client.role, session=client.session)
    call.require(route.role, f"{route.method} {request.scope['path']}")
    call = replace(call, query=read_query(route.query_fields, request.query_params))
    if route.takes_bytes:
        call = replace(call, data=await read_bytes(request, route.max_body))
    elif route.body is not None:
        call = replace(call, body=read_fields(route.body, await _json_body(route, request)))
    if route.is_long and not call.query["wait"]:
        return _start_task(route, call)
    with _giving_way(route, call):
        response = _response(route, await route.handler(call))
    if isinstance(response, EventStream):
        place = ExitStack()
        place.enter_context(station.shares.place(client))
        response.limit = partial(_streaming, access, client, place)
    return response


@asynccontextmanager
async def _streaming(access: Access, client: Client, place: ExitStack) -> AsyncIterator[None]:
    """Run a stream until the session of its client ends; then its place is free."""
    with place:
        async with ending_with_session(access, client.session):
            yield


def _giving_way(route: ApiRoute, call: Call) -> AbstractContextManager[None]:
    """Return the context in which the reads of other clients give way to a write to a vehicle."""
    return call.station.reads.writing(call.vehicle.system) if route.writes else nullcontext()


async def _json_body(route: ApiRoute, request: Request) -> dict[str, Any]:
    """Return the body; a request whose fields all have defaults needs none."""
    length = request.headers.get("content-length", "0")
    has_body = length != "0" or "transfer-encoding" in request.headers
    if not has_body and not any(each.required for each in route.body or ()):
        return {}
    return await read_json_object(request, route.max_body)


def _start_task(route: ApiRoute, call: Call) -> Response:
    if "system" in call.request.path_params:
        _ = call.vehicle  # an unknown vehicle is refused at once

    async def work(task: Task) -> Response:
        with _giving_way(route, call):
            return _response(route, await route.handler(replace(call, task=task)))

    name = f"{route.method} {call.request.url.path}"
    task = call.station.tasks.start(name, work, call.session, call.role)
    place = f"/api/tasks/{task.id}"
    values = {"task": task.id, "progress": f"{place}/progress", "result": f"{place}/result"}
    return JSONResponse(values, 202, {"Location": place})


def _response(route: ApiRoute, answer: object) -> Response:
    if isinstance(answer, Response):
        return answer
    return JSONResponse(to_json(answer), route.status, {"Cache-Control": "no-store"})
