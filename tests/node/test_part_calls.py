"""Calls of parts for user interfaces: the arguments that they take, and wrong ones."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.node import RemoteComponent
from mavstack.node.part_calls import find_call, offered_calls
from mavstack.node.parts import Part


class Box:
    def __init__(self, owner):
        self.owner = owner

    async def put(self, count: int, weight: float = 1.0, *, hard: bool = False, timeout: float | None = None):
        """Put boxes in.

        More about it.
        """
        return count, weight, hard

    async def send(self, *names: str) -> None: ...
    async def pack(self, other: Box) -> None: ...
    def weigh(self) -> float: ...


class Shelf:
    box = Part(Box, "A box.", offered=True)
    hidden = Part(Box, "A box that is not offered.")


def test_calls_with_plain_arguments_are_offered():
    (call,) = offered_calls(Shelf)
    assert (call.usage, call.summary) == ("box put COUNT [WEIGHT] [HARD]", "Put boxes in.")
    assert find_call(Shelf, "box", "put") == call
    assert find_call(Shelf, "hidden", "put") is None
    assert find_call(RemoteComponent, "terrain", "check").usage == "terrain check LATITUDE LONGITUDE"


async def test_values_and_texts_are_taken():
    call = find_call(Shelf, "box", "put")
    assert await call.run(Shelf(), {"count": 3, "weight": 2}) == (3, 2.0, False)
    assert await call.run(Shelf(), {"count": "0x10", "weight": "2.5", "hard": "on"}) == (16, 2.5, True)


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        ({}, "box put: count is missing; usage: box put COUNT"),
        ({"count": 1, "size": 2}, "size is not an argument"),
        ({"count": "many"}, "count must be an integer, got 'many'"),
        ({"count": True}, "count must be an integer, got True"),
        ({"count": 1, "hard": "maybe"}, "hard must be true or false, got 'maybe'"),
        ({"count": 1, "weight": "heavy"}, "weight must be a number, got 'heavy'"),
    ],
)
async def test_wrong_arguments_are_refused(values, problem):
    with pytest.raises(InvalidArgumentError, match=problem):
        await find_call(Shelf, "box", "put").run(Shelf(), values)
