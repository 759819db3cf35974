"""Routes that are declared by their handlers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic

import pytest

from mavstack.http.request_fields import Fields
from mavstack.http.routes import BodyT, QueryT, Route, RouteTable, Wait

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable


class Colour(Fields):
    """Set the colour.

    It is shown at once.
    """

    red: int


@dataclass(frozen=True)
class Call(Generic[BodyT, QueryT]):
    body: BodyT
    query: QueryT


@dataclass(frozen=True, slots=True, kw_only=True)
class Handled(Route[Any, Any]):
    handler: Callable[[Any], Awaitable[Any]]


def test_a_handler_declares_its_route_with_the_models_of_its_call():
    table: RouteTable[Handled] = RouteTable(Handled, "lights")

    @table.add("PUT", "/colour", status=201)
    async def paint(call: Call[Colour, Wait]) -> int:
        return call.body.red

    @table.add("GET", "/colour", "Show the colour", tag="state")
    async def show(call: Call[None, None]) -> None:
        del call

    first, second = table
    assert (first.method, first.path, first.tag, first.status) == ("PUT", "/colour", "lights", 201)
    assert (first.summary, first.body, first.query, first.handler) == ("Set the colour", Colour, Wait, paint)
    assert (second.summary, second.tag, second.body, second.query) == ("Show the colour", "state", None, None)


def test_a_call_with_one_parameter_has_no_query():
    table: RouteTable[Handled] = RouteTable(Handled, "lights")

    @table.add("PUT", "/colour")
    async def paint(_call: list[Colour]) -> None:
        """Paint."""

    assert [(each.body, each.query) for each in table] == [(Colour, None)]


def test_a_misspelled_detail_is_refused():
    table: RouteTable[Handled] = RouteTable(Handled, "lights")

    async def show(_call: Call[None, None]) -> None:
        """Show."""

    with pytest.raises(TypeError, match="stauts"):
        table.add("GET", "/colour", "Show the colour", stauts=201)(show)
