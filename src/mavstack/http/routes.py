"""The routes of an HTTP API as data: the models of their requests, and their text in the description."""

from __future__ import annotations

from dataclasses import dataclass, field
from inspect import get_annotations
from types import NoneType
from typing import TYPE_CHECKING, Annotated, Any, Final, Generic, TypeAlias, TypeVar, get_args

from msgspec import Meta

from mavstack.http.bodies import MAX_BODY
from mavstack.http.request_fields import Fields

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable, Iterator, Mapping


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
RouteT = TypeVar("RouteT", bound="Route[Any, Any]")
Handler = TypeVar("Handler", bound="Callable[[Any], Awaitable[Any]]")
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


class RouteTable(Generic[RouteT]):
    """The routes of one subject, in the order of their declarations; a handler declares its route.

    Args:
        kind: Makes a route from the fields of `Route` and the handler.
        tag: The group of the routes in the documentation.
    """

    def __init__(self, kind: Callable[..., RouteT], tag: str) -> None:
        self._kind, self._tag = kind, tag
        self._routes: list[RouteT] = []

    def __iter__(self) -> Iterator[RouteT]:
        return iter(self._routes)

    def extend(self, routes: Iterable[RouteT]) -> None:
        """Add routes whose handlers are not declared by name."""
        self._routes.extend(routes)

    def add(
        self, method: str, path: str, summary: str | None = None, **details: object
    ) -> Callable[[Handler], Handler]:
        """Declare the route of the handler that follows.

        The models of its body and its query are the parameters of the type of the call that it takes.

        Args:
            method: The HTTP method.
            path: The path, with names in braces.
            summary: One line about it; None: the first line of the model of the body.
            details: Further fields of the route; they replace those that follow from the handler.

        Returns:
            A decorator, which returns the handler.
        """

        def declare(handler: Handler) -> Handler:
            call = next(iter(get_annotations(handler, eval_str=True).values()))
            models = [*get_args(call), NoneType]
            body, query = (None if model is NoneType else model for model in models[:2])
            text = summary_of(models[0]) if summary is None else summary
            found = {"tag": self._tag, "body": body, "query": query, "handler": handler, **details}
            self._routes.append(self._kind(method=method, path=path, summary=text, **found))
            return handler

        return declare


def summary_of(model: type) -> str:
    """Return the summary of a request: the first line of its model's description."""
    return (model.__doc__ or "").partition("\n")[0].rstrip(".")
