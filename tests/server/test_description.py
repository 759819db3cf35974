from __future__ import annotations

import json
from collections import Counter

import jsonschema_rs
import msgspec

from mavstack.server.access import Access
from mavstack.server.app import ROUTES, describe_station, make_app
from mavstack.server.station import Station
from tests.server.asgi import ApiClient


async def test_the_description_has_every_route() -> None:
    app = make_app(Station(), Access(), static=None)
    document = (await ApiClient(app).get("/openapi.json")).json
    assert document["openapi"] == "3.1.0"
    described = {(method.upper(), path) for path, methods in document["paths"].items() for method in methods}
    assert described >= {(route.method, route.path.replace(":path", "")) for route in ROUTES}
    assert ("POST", "/api/session") in described


async def test_methods_that_a_path_does_not_have_are_refused_with_those_that_it_has(tmp_path) -> None:
    """Pages are below the root, so that a path that no route takes would be one of a page."""
    api = ApiClient(make_app(Station(), Access(), static=tmp_path))
    document = (await api.get("/openapi.json")).json
    for path, methods in document["paths"].items():
        for method in {"get", "put", "post", "delete", "patch", "options"} - set(methods):
            answer = await api.request(method.upper(), path)
            allowed = set(answer.headers.get("allow", "").lower().split(", "))
            assert (answer.status, allowed) == (405, set(methods)), f"{method} {path}"


def test_operations_have_ids_of_their_own_and_describe_their_parameters() -> None:
    document = describe_station()
    operations = [each for methods in document["paths"].values() for each in methods.values()]
    ids = Counter(each["operationId"] for each in operations)
    assert [name for name, count in ids.items() if count > 1] == []
    for path, methods in document["paths"].items():
        for operation in methods.values():
            named = {each["name"] for each in operation["parameters"] if each["in"] == "path"}
            assert named == {part[1:-1] for part in path.split("/") if part.startswith("{")}
            assert operation["summary"]


def test_the_examples_are_json_and_fit_their_models() -> None:
    for route in ROUTES:
        json.dumps(route.answer, allow_nan=False)
        if route.answer_model is not None:
            msgspec.convert(route.answer, route.answer_model)
    for name, schema in describe_station()["components"]["schemas"].items():
        for field in schema.get("properties", {}).values():
            for example in field.get("examples", ()):
                assert jsonschema_rs.is_valid(field, example), f"{name}: {example}"
