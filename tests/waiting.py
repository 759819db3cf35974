"""The helpers with which tests wait for a condition: in an event loop, or by steps of a simulation."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

DEFAULT_TIMEOUT = 30.0
POLL_INTERVAL = 0.01


async def wait_until(
    condition: Callable[[], object],
    description: str = "condition",
    *,
    timeout: float = DEFAULT_TIMEOUT,
    interval: float = POLL_INTERVAL,
    now: Callable[[], float] | None = None,
) -> None:
    """Poll `condition` until it is true; fail with `description` after `timeout` seconds.

    `now` is the clock that `timeout` counts by, such as that of a simulation; by default the event loop's.
    """
    clock = now or asyncio.get_running_loop().time
    deadline = clock() + timeout
    while not condition():
        assert clock() < deadline, f"not within {timeout:g} s: {description}"
        await asyncio.sleep(interval)


def step_until(
    condition: Callable[[], object],
    step: Callable[[], object],
    now: Callable[[], float],
    *,
    timeout: float = 60.0,
    description: Callable[[], object] | str = "condition",
) -> float:
    """Call `step` until `condition` is true; return the seconds that passed on the clock `now`.

    Fails after `timeout` seconds of that clock; a `description` that is a function is called for the failure.
    """
    begin = now()
    while not condition():
        text = description() if callable(description) else description
        assert now() - begin < timeout, f"not within {timeout:g} s: {text}"
        step()
    return now() - begin
