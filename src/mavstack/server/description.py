"""The parts of the OpenAPI description that all routes of the station share."""

from __future__ import annotations

from typing import Annotated, Any, Final

from msgspec import Meta, Struct

from mavstack.http.openapi import Api

_TEXT: Final[dict[str, Any]] = {"type": "string"}
#: The parameters of paths; with their example values, requests work on a simulated copter.
_PATH_PARTS: Final[dict[str, dict[str, Any]]] = {
    "system": {
        "description": "The system id of a vehicle.",
        "schema": {"type": "integer", "minimum": 1, "maximum": 255},
        "example": 1,
    },
    "name": {"description": "A name.", "schema": _TEXT, "example": "ATTITUDE"},
    "viewer": {"description": "The name of a viewer of video.", "schema": _TEXT, "example": "Zk3bR0"},
    "id": {"description": "An id.", "schema": _TEXT, "example": "1"},
    "kind": {"description": "The kind of a calibration.", "schema": _TEXT, "example": "gyroscope"},
    "camera": {
        "description": "The id of a camera: 1 to 6 for one attached to the autopilot, else its component id.",
        "schema": _TEXT,
        "example": "100",
    },
    "gimbal": {
        "description": "The device id of a gimbal; behind the component id of its manager, as in 154-1, "
        "where this is not the autopilot; 0: all of a manager.",
        "schema": _TEXT,
        "example": "1",
    },
    "component": {
        "description": "The component id of a payload.",
        "schema": {"type": "integer", "minimum": 1, "maximum": 255},
        "example": 100,
    },
    "path": {
        "description": "The path of a file on the vehicle.",
        "schema": _TEXT,
        "example": "APM/notes.txt",
    },
    "part": {"description": "The name of a service.", "schema": _TEXT, "example": "terrain"},
    "call": {"description": "The name of a call of the service.", "schema": _TEXT, "example": "check"},
    "zoom": {"description": "The zoom level of a tile.", "schema": {"type": "integer"}, "example": 10},
    "x": {
        "description": "The column of a tile, from the west.",
        "schema": {"type": "integer"},
        "example": 536,
    },
    "y": {"description": "The row of a tile, from the north.", "schema": {"type": "integer"}, "example": 358},
    "log": {"description": "The name of a recording or a log.", "schema": _TEXT, "example": "flight.tlog"},
}
_WEBSOCKETS: Final = (
    "The WebSocket `/ws` has three subprotocols. `mavstack.raw.1`: each binary message is one raw MAVLink "
    "packet or several, in both directions. `mavstack.json.1`: text messages; the client sends "
    '`{"subscribe": ["ATTITUDE"], "rate": 10, "system": 1}`, `{"unsubscribe": ["ATTITUDE"]}` or '
    '`{"send": {"message": "PING", "fields": {"seq": 1}}}` and gets one object per message. '
    "`mavstack.rows.1`: the rows of sources that do not speak MAVLink, one object each. A client with a "
    "ticket offers the subprotocols `ados-ws-ticket` and the ticket too."
)


class Problem(Struct, omit_defaults=True):
    """An error in words, with the vehicle's reasons if it refused the request."""

    kind: Annotated[str, Meta(description="The kind of the error, such as CommandDenied.")]
    text: Annotated[str, Meta(description="The error in words.")]
    code: Annotated[int | None, Meta(description="The vehicle's number of its reason.")] = None
    status_texts: tuple[str, ...] = ()
    events: Annotated[tuple[str, ...], Meta(description="Messages of PX4's events, its other reasons.")] = ()
    systems: Annotated[tuple[int, ...], Meta(description="The vehicles that stopped the swarm.")] = ()


class Error(Struct):
    """The answer to a request that is refused or fails."""

    error: Problem


class StartedTask(Struct):
    """The answer to long work with `wait=false`."""

    task: Annotated[str, Meta(description="The id of the task.")]
    progress: Annotated[str, Meta(description="The path of its server-sent events.")]
    result: Annotated[str, Meta(description="The path of the answer, once it is done.")]


API: Final = Api(
    title="Mavstack ground station",
    version="1.0",
    about=_WEBSOCKETS,
    path_parts=_PATH_PARTS,
    error=Error,
    errors=(400, 401, 403, 404, 409, 413, 415, 429, 500, 501, 502, 503, 504),
    task=StartedTask,
    security={
        "session": {"type": "http", "scheme": "bearer"},
        "cookie": {"type": "apiKey", "in": "cookie", "name": "mavstack_session"},
    },
    prefix="/api",
)
