from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.bridges.ros2.put_queue import PutQueue

if TYPE_CHECKING:
    from collections.abc import Callable


def test_samples_of_a_turn_are_put_together_in_their_order() -> None:
    scheduled: list[Callable[[], None]] = []
    sent: list[tuple[bytes, bytes]] = []
    queue = PutQueue(scheduled.append)

    def put(payload: bytes, attachment: bytes) -> None:
        sent.append((payload, attachment))
        if payload == b"a":
            queue.add(put, b"c", b"3")  # a sample that another one causes

    queue.add(put, b"a", b"1")
    queue.add(put, b"b", b"2")
    assert sent == []
    assert len(scheduled) == 1
    scheduled.pop()()
    assert sent == [(b"a", b"1"), (b"b", b"2")]
    scheduled.pop()()
    assert sent[-1] == (b"c", b"3")


def test_a_session_that_closes_gets_nothing() -> None:
    scheduled: list[Callable[[], None]] = []
    sent: list[bytes] = []
    queue = PutQueue(scheduled.append)
    queue.add(lambda payload, attachment: sent.append(payload), b"a", b"1")
    queue.clear()
    scheduled.pop()()
    assert sent == []
