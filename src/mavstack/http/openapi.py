"""The OpenAPI description of an HTTP API, from its routes and the models of their requests and answers."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import TYPE_CHECKING, Any, Final

from msgspec.json import schema_components
from msgspec.structs import fields

from mavstack.http.routes import ANY_MEDIA_TYPE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from mavstack.http.routes import Route

_REFERENCE: Final = "#/components/schemas/{name}"
_PATH_PART: Final = re.compile(r"{(\w+)(?::path)?}")
_BINARY: Final = {"type": "string", "format": "binary"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Api:
    """The parts of a description that all routes share.

    Attributes:
        title: The name of the API.
        version: Its version.
        about: The text about it.
        path_parts: The schema, `description` and `example` of each part of a path, by its name.
        error: The model of the answer to a request that is refused.
        errors: The statuses of refused requests.
        task: The model of the answer to long work with `wait=false`.
        security: The schemes by which clients identify themselves, by name.
        prefix: The beginning of paths that the ids of operations leave out.
    """

    title: str
    version: str
    about: str
    path_parts: Mapping[str, Mapping[str, Any]]
    error: Any
    errors: Sequence[int]
    task: Any = None
    security: Mapping[str, Any] = field(default_factory=dict)
    prefix: str = ""


def describe(routes: Iterable[Route[Any, Any]], api: Api) -> dict[str, Any]:
    """Return the OpenAPI 3.1 document of an API."""
    routes = tuple(routes)
    schemas = _Schemas(routes, api)
    paths: dict[str, dict[str, Any]] = {}
    for route in routes:
        path = _PATH_PART.sub(r"{\1}", route.path)
        paths.setdefault(path, {})[route.method.lower()] = _operation(route, api, schemas)
    return {
        "openapi": "3.1.0",
        "info": {"title": api.title, "version": api.version, "description": api.about},
        "paths": paths,
        "components": {
            "schemas": schemas.named,
            "responses": _errors(api, schemas),
            "securitySchemes": dict(api.security),
        },
        "security": [{}, *({name: []} for name in api.security)],
    }


class _Schemas:
    """The JSON Schemas of all models, of which nested ones are named too."""

    def __init__(self, routes: Iterable[Route[Any, Any]], api: Api) -> None:
        models = [api.error, api.task]
        for route in routes:
            models += [route.body, route.query, route.answer_model]
        self._models = list(dict.fromkeys(each for each in models if each is not None))
        found, self.named = schema_components(self._models, ref_template=_REFERENCE)
        self._of = dict(zip(self._models, found, strict=True))
        for route in routes:
            if route.body is not None:
                _allow_null(self.named[route.body.__name__])
            if route.query is not None:
                self.named.pop(route.query.__name__, None)

    def of(self, model: Any) -> dict[str, Any]:  # noqa: ANN401 (any type that msgspec knows)
        """Return the schema of a model."""
        return dict(self._of[model])


def _allow_null(body: dict[str, Any]) -> None:
    """Describe that null is the default of a field that has one."""
    for name, each in body["properties"].items():
        if name in body["required"]:
            continue
        if "anyOf" in each and {"type": "null"} not in each["anyOf"]:
            each["anyOf"] = [*each["anyOf"], {"type": "null"}]
        elif isinstance(each.get("type"), str):
            each["type"] = [each["type"], "null"]


def _operation(route: Route[Any, Any], api: Api, schemas: _Schemas) -> dict[str, Any]:
    found: dict[str, Any] = {
        "operationId": _identifier(route, api.prefix),
        "summary": route.summary,
        "tags": [route.tag],
        "description": route.about,
        "parameters": [*_path_parameters(route, api), *_query_parameters(route)],
        "responses": _responses(route, api, schemas),
    }
    if route.takes_bytes:
        content = {"application/octet-stream": {"schema": _BINARY}}
        found["requestBody"] = {"required": route.has_body, "content": content}
    elif route.body is not None:
        required = any(each.required for each in fields(route.body))
        content = {"application/json": {"schema": schemas.of(route.body)}}
        found["requestBody"] = {"required": required, "content": content}
    return found


def _identifier(route: Route[Any, Any], prefix: str) -> str:
    words = re.findall(r"[A-Za-z]+", route.path.removeprefix(prefix).replace(":path", ""))
    return "_".join([route.method.lower(), *words])


def _path_parameters(route: Route[Any, Any], api: Api) -> list[dict[str, Any]]:
    return [
        {"name": name, "in": "path", "required": True}
        | dict(api.path_parts[name])
        | ({"example": route.path_examples[name]} if name in route.path_examples else {})
        for name in _PATH_PART.findall(route.path)
    ]


def _query_parameters(route: Route[Any, Any]) -> list[dict[str, Any]]:
    if route.query is None:
        return []
    _, named = schema_components([route.query], ref_template=_REFERENCE)
    query = named[route.query.__name__]
    required: list[str] = query.get("required", [])
    properties: dict[str, dict[str, Any]] = query["properties"]
    return [
        {"name": name, "in": "query", "description": each.pop("description", ""), "schema": _not_null(each)}
        | ({"required": True} if name in required else {})
        for name, each in properties.items()
    ]


def _not_null(schema: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of a value in a query, which has no null."""
    kinds = schema.pop("anyOf", [])
    for each in kinds:
        schema |= {} if each == {"type": "null"} else each
    if schema.get("default", "") is None:
        del schema["default"]
    return schema


def _responses(route: Route[Any, Any], api: Api, schemas: _Schemas) -> dict[str, Any]:
    answer: dict[str, Any] = {"schema": _answer_schema(route, schemas)}
    if route.answer is not None and route.media_type == "application/json":
        answer["example"] = route.answer
    found = {str(route.status): {"description": route.summary, "content": {route.media_type: answer}}}
    if route.is_long:
        content = {"application/json": {"schema": schemas.of(api.task)}}
        found["202"] = {"description": "The task, with wait=false", "content": content}
    return found | {
        str(status): {"$ref": f"#/components/responses/{_error_name(status)}"} for status in api.errors
    }


def _error_name(status: int) -> str:
    return HTTPStatus(status).name.title().replace("_", "")


def _errors(api: Api, schemas: _Schemas) -> dict[str, Any]:
    content = {"application/json": {"schema": schemas.of(api.error)}}
    return {
        _error_name(status): {"description": HTTPStatus(status).phrase, "content": content}
        for status in api.errors
    }


def _answer_schema(route: Route[Any, Any], schemas: _Schemas) -> dict[str, Any]:
    """Return the schema of an answer; without a model the keys of its example are known, not their types."""
    if route.answer_model is not None:
        return schemas.of(route.answer_model)
    match route.media_type, route.answer:
        case "application/octet-stream", _:
            return _BINARY
        case media_type, _ if media_type == ANY_MEDIA_TYPE:
            return {}
        case media_type, _ if media_type != "application/json":
            return {"type": "string"}
        case _, list():
            return {"type": "array", "items": {"type": "object"}}
        case _, dict() if route.answer:
            return {"type": "object", "required": sorted(route.answer)}
    return {}
