"""The routes of an HTTP API as data: the models of their requests, and their text in the description."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, Final, Generic, TypeAlias, TypeVar

from msgspec import Meta

from mavstack.http.bodies import MAX_BODY
from mavstack.http.request_fields import Fields

if TYPE_CHECKING:
    from collections.abc import Mapping


WaitField: TypeAlias = Annotated[
    bool, Meta(description="False: answer at once with 202 and the id of a task.")
]


class NoFields(Fields):
    """A body or a query without fields."""


class Wait(Fields):
    """The query of routes whose work may take long."""

    wait: WaitField = True


BodyT = TypeVar("BodyT")
QueryT = TypeVar("QueryT")
#: The media type of an answer that repeats the stored answer of another route.
ANY_MEDIA_TYPE: Final = "*/*"


@dataclass(frozen=True, slots=True, kw_only=True)
class Route(Generic[BodyT, QueryT]):
    """A route.

    Attributes:
        method: The HTTP method.
        path: The path, with names in braces.
        summary: One line about it.
        tag: The group in the documentation.
        about: More about it, such as the role that a client needs.
        body: The model of the JSON body; None: no body.
        query: The model of the query; None: no query.
        takes_bytes: True if the body is not JSON but any bytes, up to `max_body`.
        has_body: False: a request with `takes_bytes` may have no body.
        max_body: The largest body in bytes.
        status: The status of the answer.
        answer: An example of the answer.
        answer_model: The type of the answer; None: only the keys of the example are known.
        media_type: The media type of the answer; `ANY_MEDIA_TYPE`: that of another route.
        path_examples: Examples of parts of the path that differ from those of other routes.
    """

    method: str
    path: str
    summary: str
    tag: str
    about: str = ""
    body: type[BodyT] | None = None
    query: type[QueryT] | None = None
    takes_bytes: bool = False
    has_body: bool = True
    max_body: int = MAX_BODY
    status: int = 200
    answer: Any = None
    answer_model: Any = None
    media_type: str = "application/json"
    path_examples: Mapping[str, Any] = field(default_factory=dict)

    @property
    def is_long(self) -> bool:
        """True if the work may run on as a task, with `wait=false`."""
        return "wait" in getattr(self.query, "__struct_fields__", ())
