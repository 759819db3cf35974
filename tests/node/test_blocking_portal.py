from __future__ import annotations

import asyncio
from threading import Event
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.node.blocking_portal import BlockingPortal

if TYPE_CHECKING:
    from collections.abc import Coroutine, Iterator


@pytest.fixture
def portal() -> Iterator[BlockingPortal]:
    running = BlockingPortal()
    yield running
    running.close()


def test_ctrl_c_right_after_the_submission_cancels_the_call(
    portal: BlockingPortal, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended = Event()
    submit = asyncio.run_coroutine_threadsafe

    async def work() -> None:
        try:
            await asyncio.Event().wait()
        finally:
            ended.set()

    def submit_and_interrupt(call: Coroutine[Any, Any, Any], loop: asyncio.AbstractEventLoop) -> None:
        monkeypatch.undo()
        submit(call, loop)
        raise KeyboardInterrupt

    monkeypatch.setattr(asyncio, "run_coroutine_threadsafe", submit_and_interrupt)
    with pytest.raises(KeyboardInterrupt):
        portal.wait(work())
    assert ended.is_set()
    assert portal.call(lambda: 7) == 7
