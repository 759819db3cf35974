"""The OpenAPI description of the station's API, made from the table of its routes."""

from __future__ import annotations

import re
from http import HTTPStatus
from typing import TYPE_CHECKING, Any, Final

from mavstack.http.bodies import MAX_BODY
from mavstack.server.api_route import ANY_MEDIA_TYPE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.server.api_route import ApiRoute
    from mavstack.server.fields import Field

_PATH_PART: Final = re.compile(r"{(\w+)(?::path)?}")
_PATH_ABOUT: Final = {
    "system": "The system id of a vehicle.",
    "name": "A name.",
    "id": "An id.",
    "kind": "The kind of a calibration.",
    "camera": "The id of a camera: 1 to 6 for one attached to the autopilot, else its component id.",
    "path": "The path of a file on the vehicle.",
    "log": "The name of a recording or a log.",
}
#: Values of the parts of paths, with which the examples work on a simulated copter.
_PATH_EXAMPLES: Final[dict[str, Any]] = {
    "system": 1,
    "name": "ATTITUDE",
    "id": "1",
    "path": "APM/notes.txt",
    "log": "flight.tlog",
    "kind": "gyroscope",
    "camera": "100",
}
_ERROR: Final[dict[str, Any]] = {
    "type": "object",
    "required": ["error"],
    "properties": {
        "error": {
            "type": "object",
            "required": ["kind", "text"],
            "properties": {
                "kind": {"type": "string", "description": "The kind of the error, such as CommandDenied."},
                "text": {"type": "string", "description": "The error in words."},
                "code": {"type": "integer", "description": "The vehicle's number of its reason."},
                "status_texts": {"type": "array", "items": {"type": "string"}},
            },
        }
    },
}
_TASK: Final[dict[str, Any]] = {
    "type": "object",
    "required": ["task", "progress", "result"],
    "properties": {
        "task": {"type": "string", "description": "The id of the task."},
        "progress": {"type": "string", "description": "The path of its server-sent events."},
        "result": {"type": "string", "description": "The path of the answer, once it is done."},
    },
}
#: The errors of every route, and those of routes that ask a vehicle.
_COMMON_ERRORS: Final = (400, 401, 403, 404)
_OTHER_ERRORS: Final = (409, 413, 415, 429, 500, 501, 502, 503, 504)
_WEBSOCKETS: Final = (
    "The WebSocket `/ws` has three subprotocols. `mavstack.raw.1`: each binary message is one raw MAVLink "
    "packet or several, in both directions. `mavstack.json.1`: text messages; the client sends "
    '`{"subscribe": ["ATTITUDE"], "rate": 10, "system": 1}`, `{"unsubscribe": ["ATTITUDE"]}` or '
    '`{"send": {"message": "PING", "fields": {"seq": 1}}}` and gets one object per message. '
    "`mavstack.rows.1`: the rows of sources that do not speak MAVLink, one object each. A client with a "
    "ticket offers the subprotocols `ados-ws-ticket` and the ticket too."
)


def describe(routes: Iterable[ApiRoute], version: str) -> dict[str, Any]:
    """Return the description of an API.

    Args:
        routes: The routes.
        version: The version of the API.

    Returns:
        The OpenAPI 3.1 document.
    """
    paths: dict[str, dict[str, Any]] = {}
    for route in routes:
        path = _PATH_PART.sub(r"{\1}", route.path)
        paths.setdefault(path, {})[route.method.lower()] = _operation(route)
    return {
        "openapi": "3.1.0",
        "info": {"title": "Mavstack ground station", "version": version, "description": _WEBSOCKETS},
        "paths": paths,
        "components": {
            "schemas": {"Error": _ERROR, "Task": _TASK},
            "securitySchemes": {
                "session": {"type": "http", "scheme": "bearer"},
                "cookie": {"type": "apiKey", "in": "cookie", "name": "mavstack_session"},
            },
        },
        "security": [{}, {"session": []}, {"cookie": []}],
    }


def _operation(route: ApiRoute) -> dict[str, Any]:
    found: dict[str, Any] = {
        "operationId": _identifier(route),
        "summary": route.summary,
        "tags": [route.tag],
        "description": f"Needs the role {route.role.word}.",
        "parameters": [*_path_parameters(route), *map(_query_parameter, route.query_fields)],
        "responses": _responses(route),
    }
    if route.takes_bytes:
        content = {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}
        found["requestBody"] = {"required": route.has_body, "content": content}
    elif route.body is not None:
        required = any(each.required for each in route.body)
        content = {"application/json": {"schema": _body_schema(route.body)}}
        found["requestBody"] = {"required": required, "content": content}
    return found


def _identifier(route: ApiRoute) -> str:
    words = re.findall(r"[A-Za-z]+", route.path.removeprefix("/api").replace(":path", ""))
    return "_".join([route.method.lower(), *words])


def _path_parameters(route: ApiRoute) -> list[dict[str, Any]]:
    examples = {**_PATH_EXAMPLES, **route.path_examples}
    return [_path_parameter(name, examples[name]) for name in _PATH_PART.findall(route.path)]


def _path_parameter(name: str, example: object) -> dict[str, Any]:
    is_system = name == "system"
    schema = {"type": "integer", "minimum": 1, "maximum": 255} if is_system else {"type": "string"}
    about = _PATH_ABOUT[name]
    return {
        "name": name,
        "in": "path",
        "required": True,
        "description": about,
        "schema": schema,
        "example": example,
    }


def _query_parameter(field: Field) -> dict[str, Any]:
    schema = {key: value for key, value in field.schema().items() if key != "description"}
    schema["type"] = field.type  # a query has no null
    if field.choices:
        schema["enum"] = list(field.choices)
    return {"name": field.name, "in": "query", "description": field.about, "schema": schema}


def _body_schema(fields: tuple[Field, ...]) -> dict[str, Any]:
    return {
        "type": "object",
        "required": [each.name for each in fields if each.required],
        "properties": {each.name: each.schema() for each in fields},
        "additionalProperties": False,
        "description": f"At most {MAX_BODY} bytes.",
    }


def _responses(route: ApiRoute) -> dict[str, Any]:
    answer: dict[str, Any] = {"schema": _schema_of(route)}
    if route.answer is not None and route.media_type == "application/json":
        answer["example"] = route.answer
    found = {str(route.status): {"description": route.summary, "content": {route.media_type: answer}}}
    if route.is_long:
        content = {"application/json": {"schema": {"$ref": "#/components/schemas/Task"}}}
        found["202"] = {"description": "The task, with wait=false", "content": content}
    error = {"application/json": {"schema": {"$ref": "#/components/schemas/Error"}}}
    for status in (*_COMMON_ERRORS, *_OTHER_ERRORS):
        found[str(status)] = {"description": HTTPStatus(status).phrase, "content": error}
    return found


def _schema_of(route: ApiRoute) -> dict[str, Any]:
    """Return the schema of an answer, from its example: the keys are sure, values may be null."""
    if route.media_type == "application/octet-stream":
        return {"type": "string", "format": "binary"}
    if route.media_type == ANY_MEDIA_TYPE:
        return {}
    if route.media_type != "application/json":
        return {"type": "string"}
    match route.answer:
        case list():
            return {"type": "array", "items": {"type": "object"}}
        case {} if route.answer:
            return {"type": "object", "required": sorted(route.answer)}
        case _:
            return {}
