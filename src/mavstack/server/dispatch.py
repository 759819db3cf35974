"""From a request to its answer: the checks that all routes share, the handler, and errors as JSON."""

from __future__ import annotations

import logging
from contextlib import AbstractContextManager, ExitStack, asynccontextmanager, nullcontext
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from msgspec.structs import fields as struct_fields
from starlette.requests import ClientDisconnect
from starlette.responses import JSONResponse, Response

from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError, has_body, read_bytes, read_json_object
from mavstack.http.connections import mark_client
from mavstack.http.request_fields import read_fields, read_query
from mavstack.http.routes import NoFields
from mavstack.security.roles import Role
from mavstack.server.api.events import EventStream
from mavstack.server.api_route import AnyRoute, Call
from mavstack.server.json_values import to_json
from mavstack.server.problems import problem_json, status_of
from mavstack.server.session_end import ending_with_session

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from starlette.requests import Request

    from mavstack.http.request_fields import Fields
    from mavstack.server.access import Access, Client
    from mavstack.server.station import Station
    from mavstack.server.tasks import Task

logger = logging.getLogger("mavstack.server")


def endpoint_of(
    route: AnyRoute, station: Station, access: Access
) -> Callable[[Request], Awaitable[Response]]:
    """Return the function of a route that Starlette calls."""

    async def endpoint(request: Request) -> Response:
        try:
            return await _answer(route, station, access, request)
        except (RefusedError, MavstackError) as error:
            return problem_response(error)
        except ClientDisconnect:  # the client left during its request, so no client reads the answer
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


async def _answer(route: AnyRoute, station: Station, access: Access, request: Request) -> Response:
    client = access.check_request(request)
    mark_client(client.proof, client.holder)
    _check_role(route, client, request)
    query = read_query(route.query or NoFields, request.query_params)
    body, data = await _read_body(route, request)
    call = Call(
        station=station,
        request=request,
        role=client.role,
        session=client.session,
        query=query,
        body=body,
        data=data,
    )
    if not getattr(query, "wait", True):
        return _start_task(route, call)
    with _giving_way(route, call):
        answer = await route.handler(call)
    if client.role is Role.OBSERVE:
        await station.answer_lane.turn()
    response = _response(route, answer)
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


def _giving_way(route: AnyRoute, call: Call[Any, Any]) -> AbstractContextManager[None]:
    """Return the context in which the reads of other clients give way to a write to a vehicle."""
    return call.station.reads.writing(call.vehicle.system) if route.writes else nullcontext()


def _check_role(route: AnyRoute, client: Client, request: Request) -> None:
    if client.role < route.role:
        name = f"{route.method} {request.scope['path']}"
        raise RefusedError(403, f"{name} needs the role {route.role.word}; yours is {client.role.word}")


async def _read_body(route: AnyRoute, request: Request) -> tuple[Fields | None, bytes]:
    """Return the fields of the body and its bytes; a body whose fields all have defaults may be missing."""
    if route.takes_bytes:
        return None, await read_bytes(request, route.max_body)
    if route.body is None:
        return None, b""
    is_needed = any(each.required for each in struct_fields(route.body))
    values = await read_json_object(request, route.max_body) if is_needed or has_body(request.scope) else {}
    return read_fields(route.body, values), b""


def _start_task(route: AnyRoute, call: Call[Any, Any]) -> Response:
    if "system" in call.request.path_params:
        _ = call.vehicle  # raises the refusal of an unknown vehicle before the task starts

    async def work(task: Task) -> Response:
        with _giving_way(route, call):
            return _response(route, await route.handler(replace(call, task=task)))

    name = f"{route.method} {call.request.url.path}"
    task = call.station.tasks.start(name, work, call.session, call.role)
    place = f"/api/tasks/{task.id}"
    values = {"task": task.id, "progress": f"{place}/progress", "result": f"{place}/result"}
    return JSONResponse(values, 202, {"Location": place})


def _response(route: AnyRoute, answer: object) -> Response:
    if isinstance(answer, Response):
        return answer
    return JSONResponse(to_json(answer), route.status, {"Cache-Control": "no-store"})
