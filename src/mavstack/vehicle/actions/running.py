"""The steps of every flight action: the request, its reversal if it fails, and the wait for the goal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.vehicle.action_monitor import ActionGoal, ActionMonitor
from mavstack.vehicle.firmware.changes import kept_only_if_reached, undone_on_failure
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Any

    from mavstack.vehicle.firmware.changes import Changes
    from mavstack.vehicle.vehicle import Vehicle


async def run_action(
    vehicle: Vehicle,
    operation: str,
    request: Coroutine[Any, Any, None],
    goal: Callable[[], ActionGoal],
    *,
    changes: Changes,
    wait: bool,
    timeout: float | None,
) -> None:
    """Request an action, reverse the steps of a request that fails, and wait until its goal is reached.

    An action that fails later restores the parameters that the vehicle read at its start; the mode stays,
    since the vehicle may fly by it.
    """
    try:
        async with kept_only_if_reached(changes), ActionMonitor(vehicle, operation, timeout) as monitor:
            async with undone_on_failure(changes):
                await with_status_texts(vehicle, request)
            if wait:
                await monitor.wait_until_reached(goal())
    finally:
        request.close()  # for a coroutine that was never awaited


def relative_altitude_of(vehicle: Vehicle) -> float | None:
    """Return the altitude in metres above home; None if it is not known."""
    position = vehicle.position
    return None if position is None else position.relative_altitude


def remaining_timeout(vehicle: Vehicle, timeout: float | None, started: float) -> float | None:
    """Return the seconds that are left of a timeout; None sets no limit."""
    return None if timeout is None else max(timeout - (vehicle.connection.now() - started), 0.0)
