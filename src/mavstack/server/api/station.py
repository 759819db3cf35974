"""The station itself: its sources, tasks and statistics."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any, Final
from urllib.parse import quote

from msgspec import Meta

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import ANY_MEDIA_TYPE, RouteTable
from mavstack.links import open_link
from mavstack.security.roles import Role
from mavstack.server.api.events import EventStream
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.json_values import to_json
from mavstack.server.request_types import Text
from mavstack.server.tasks import TaskState

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.server.tasks import Task


_SOURCE: Final = {
    "id": "1",
    "url": "udpin://0.0.0.0:14550",
    "state": "connected",
    "address": ["0.0.0.0", 14550],  # noqa: S104 (an example)
    "channels": ["127.0.0.1:52000"],
    "counters": {"bytes_in": 5120, "bytes_out": 210, "chunks_in": 80, "chunks_out": 10},
}
_TASK: Final = {
    "task": "1",
    "name": "GET /api/vehicles/1/parameters",
    "state": "running",
    "done": 210,
    "total": 900,
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "station")


@ROUTES.add("GET", "/api/sources", "List the sources: links of the station", answer=[_SOURCE])
async def _list_sources(call: PlainCall) -> list[dict[str, Any]]:
    return [source.values() for source in call.station.sources.list()]


@ROUTES.add(
    "GET",
    "/api/rows",
    "Show the latest row of each message of the sources that do not speak MAVLink",
    answer=[
        {
            "source": "cansat",
            "message": "ROW",
            "time": 1790000000.0,
            "fields": {"alt": 512.3},
            "count": 10,
        }
    ],
)
async def _list_rows(call: PlainCall) -> list[dict[str, Any]]:
    return [{**each.value, "count": each.count} for each in call.station.sources.rows.latest.values()]


class AddSource(Fields):
    """Add a source: a link, or the replay of a recording."""

    url: Annotated[
        Text | None,
        Meta(
            description="A link; rows: csv+tcp://HOST:PORT?name=cansat&template=time:s,alt:m; "
            "frames of bytes: frames+udp://HOST:PORT?name=bench; or null.",
            examples=["udpin://0.0.0.0:14550"],
        ),
    ] = None
    decoder: Annotated[
        dict[str, Any] | None,
        Meta(description="The declaration of the decoder of frames; null: scripts read their bytes."),
    ] = None
    recording: Annotated[Text | None, Meta(description="The name of a recording to replay, or null.")] = None
    speed: Annotated[float, Meta(description="The speed of a replay; 1: as it was recorded.", ge=0.01)] = 1.0


@ROUTES.add("POST", "/api/sources", role=Role.ADMINISTER, status=201, answer=_SOURCE)
async def _add_source(call: Call[AddSource, None]) -> dict[str, Any]:
    url, recording, sources = call.body.url, call.body.recording, call.station.sources
    if url is not None and recording is None:
        return (await sources.add(url, decoder=call.body.decoder, from_client=True)).values()
    if recording is None or url is not None:
        raise RefusedError(400, "either a url or a recording is needed")
    replay = open_link(f"file://{quote(str(call.station.recordings.path(recording)))}", speed=call.body.speed)
    return (await sources.add(replay)).values()


@ROUTES.add(
    "DELETE",
    "/api/sources/{id}",
    "Remove a source",
    role=Role.ADMINISTER,
    answer=_SOURCE | {"state": "closed", "channels": []},
)
async def _remove_source(call: PlainCall) -> dict[str, Any]:
    return (await call.station.sources.remove(call.path("id"))).values()


@ROUTES.add("GET", "/api/tasks", "List the tasks", tag="tasks", answer=[_TASK])
async def _list_tasks(call: PlainCall) -> list[dict[str, Any]]:
    return [task.values() for task in call.station.tasks.list() if _may_see(call, task)]


@ROUTES.add("GET", "/api/tasks/{id}", "Show a task", tag="tasks", answer=_TASK)
async def _show_task(call: PlainCall) -> dict[str, Any]:
    return _task(call).values()


@ROUTES.add(
    "GET",
    "/api/tasks/{id}/progress",
    "Follow a task by server-sent events",
    tag="tasks",
    media_type="text/event-stream",
    answer="event: progress",
)
async def _follow_task(call: PlainCall) -> EventStream:
    return EventStream(_events(_task(call)))


@ROUTES.add(
    "GET",
    "/api/tasks/{id}/result",
    "Get the answer of a task that is done",
    tag="tasks",
    media_type=ANY_MEDIA_TYPE,
)
async def _task_result(call: PlainCall) -> Any:  # noqa: ANN401 (the answer of the request)
    task = _task(call)
    if task.error is not None:
        raise task.error
    if task.state is not TaskState.DONE:
        raise RefusedError(409, f"the task {task.id} is {task.state.value}: it has no result")
    return task.result


@ROUTES.add(
    "DELETE", "/api/tasks/{id}", "Cancel and drop a task", tag="tasks", answer=_TASK | {"state": "cancelled"}
)
async def _remove_task(call: PlainCall) -> dict[str, Any]:
    return (await call.station.tasks.remove(_task(call).id)).values()


@ROUTES.add(
    "GET",
    "/api/statistics",
    "Show counters of channels and clients",
    answer={
        "time": 1790000000.0,
        "packets": 1000,
        "vehicles": 1,
        "clients": 2,
        "router": False,
        "channels": [],
    },
)
async def _statistics(call: PlainCall) -> dict[str, Any]:
    station = call.station
    node = station.connection
    channels = [
        {
            "source": source.id,
            "channel": channel.name,
            "counters": to_json(channel.counters),
            **_parsed(call, channel),
        }
        for source in station.sources.list()
        for channel in source.link.channels
    ]
    return {
        "time": node.now(),
        "packets": station.packets.received,
        "vehicles": len(node.vehicles),
        "clients": len(station.packets.clients),
        "router": station.router is not None,
        "channels": channels,
    }


def _parsed(call: PlainCall, channel: Any) -> dict[str, Any]:  # noqa: ANN401 (a channel of any link)
    state = call.station.connection.channel_state(channel)
    if state is None:
        return {}
    totals = state.parser.statistics
    names = ("packets", "bad_bytes", "bad_checksum", "signed", "unknown")
    sources = {
        f"{system}/{component}": {"received": each.received, "lost": each.lost}
        for (system, component), each in state.parser.sources.items()
    }
    return {**{name: getattr(totals, name) for name in names}, "sources": sources, "thinned": state.thinned}


def _task(call: PlainCall) -> Task:
    task = call.station.tasks.find(call.path("id"))
    if not _may_see(call, task):
        raise RefusedError(404, f"there is no task {task.id}")
    return task


def _may_see(call: PlainCall, task: Task) -> bool:
    """Return whether a client may see a task: its own, or any for an administrator."""
    return call.role is Role.ADMINISTER or task.owner == call.session


async def _events(task: Task) -> AsyncIterator[str]:
    """Yield server-sent events: `progress` while the task runs, then `done`, `failed` or `cancelled`."""
    async for values in task.follow():
        running = values["state"] == TaskState.RUNNING.value
        name = "progress" if running else values["state"]
        yield f"event: {name}\ndata: {json.dumps(to_json(values))}\n\n"
