from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from mavstack.http.openapi import Api, describe
from mavstack.http.request_fields import Fields
from mavstack.http.routes import Route, Wait


class Turn(Fields):
    """Turn to a heading."""

    heading: Annotated[float, Meta(description="Degrees.", ge=0, le=360)]
    fast: bool = False


class Heading(Struct):
    heading: float


class Problem(Struct):
    text: str


API = Api(
    title="Turner",
    version="2",
    about="Turns.",
    path_parts={"id": {"description": "An id.", "schema": {"type": "string"}, "example": "7"}},
    error=Problem,
    errors=(400,),
    task=Problem,
)
TURN = Route(
    method="POST", path="/turn/{id}", summary="Turn", tag="a", body=Turn, query=Wait, answer_model=Heading
)


def test_the_models_are_schemas_of_the_document() -> None:
    document = describe([TURN], API)
    turn = document["paths"]["/turn/{id}"]["post"]
    body = turn["requestBody"]
    assert body["required"] is True
    assert body["content"]["application/json"]["schema"] == {"$ref": "#/components/schemas/Turn"}
    schemas = document["components"]["schemas"]
    assert schemas["Turn"]["required"] == ["heading"]
    assert schemas["Turn"]["properties"]["heading"] == {
        "description": "Degrees.",
        "type": "number",
        "minimum": 0,
        "maximum": 360,
    }
    assert set(schemas) == {"Turn", "Heading", "Problem"}
    assert turn["responses"]["400"] == {"$ref": "#/components/responses/BadRequest"}
    refused = document["components"]["responses"]["BadRequest"]["content"]["application/json"]
    assert refused == {"schema": {"$ref": "#/components/schemas/Problem"}}
    answer = turn["responses"]["200"]["content"]["application/json"]["schema"]
    assert answer == {"$ref": "#/components/schemas/Heading"}


def test_null_is_the_default_of_a_body_but_not_of_a_query() -> None:
    document = describe([TURN], API)
    assert document["components"]["schemas"]["Turn"]["properties"]["fast"]["type"] == ["boolean", "null"]
    (path, wait) = document["paths"]["/turn/{id}"]["post"]["parameters"]
    assert (path["name"], path["example"], wait["name"]) == ("id", "7", "wait")
    assert wait["schema"] == {"type": "boolean", "default": True}


def test_a_field_of_a_query_without_a_default_is_required() -> None:
    route = Route(method="GET", path="/turn/{id}", summary="Show", tag="a", query=Turn, answer={})
    (_, heading, fast) = describe([route], API)["paths"]["/turn/{id}"]["get"]["parameters"]
    assert (heading["name"], heading["required"]) == ("heading", True)
    assert "required" not in fast


def test_long_work_may_be_a_task() -> None:
    plain = Route(method="GET", path="/turn/{id}", summary="Show", tag="a", answer={"b": 1, "a": None})
    paths = describe([TURN, plain], API)["paths"]["/turn/{id}"]
    assert "202" in paths["post"]["responses"]
    assert set(paths["get"]["responses"]) == {"200", "400"}
    answer = paths["get"]["responses"]["200"]["content"]["application/json"]
    assert answer == {"schema": {"type": "object", "required": ["a", "b"]}, "example": {"b": 1, "a": None}}
