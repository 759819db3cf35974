"""Running a winch: the vehicle acknowledges the start, and its WINCH_STATUS reports line and speed.

A vehicle that sends no WINCH_STATUS, or one without the needed value, is trusted to do what it acknowledged.
"""

from __future__ import annotations

import asyncio
from math import copysign, isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.action_monitor import ActionGoal, ActionMonitor
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Any

    from mavstack.vehicle.vehicle import Vehicle

#: The rate at which WINCH_STATUS is requested, in hertz.
STATUS_RATE: Final = 4.0
#: A younger status is current; otherwise a new status is waited for this long, in seconds.
STATUS_TIMEOUT: Final = 2.0
#: The difference in metres up to which the line has the requested length.
LENGTH_TOLERANCE: Final = 0.1
#: Speed below which a winch counts as stopped, in m/s.
_STANDSTILL: Final = 0.02
_FLAG: Final = common.MavWinchStatusFlag


async def unwind(
    vehicle: Vehicle,
    number: int,
    request: Coroutine[Any, Any, object],
    length: float,
    *,
    wait: bool,
    timeout: float | None,
) -> None:
    """Pay out line, or wind it in, until it has its length; see `Actuators.unwind`."""

    def goal_of(before: common.WinchStatus) -> ActionGoal | None:
        end = before.line_length + length
        if not isfinite(end):
            return None

        def remaining() -> float:
            status = vehicle.latest(common.WinchStatus) or before
            if length < 0 and status.status & _FLAG.FULLY_RETRACTED:
                return 0.0
            return max(copysign(1.0, length) * (end - status.line_length), 0.0)

        return ActionGoal(
            lambda: remaining() <= LENGTH_TOLERANCE, remaining, signs=lambda: round(remaining(), 1)
        )

    await _run(vehicle, number, request, goal_of if wait else None, timeout)


async def run(
    vehicle: Vehicle,
    number: int,
    request: Coroutine[Any, Any, object],
    rate: float,
    *,
    wait: bool,
    timeout: float | None,
) -> None:
    """Run a winch until it moves, or stands still if the rate is 0; see `Actuators.run_winch`."""

    def goal_of(before: common.WinchStatus) -> ActionGoal | None:
        if not isfinite(before.speed):
            return None
        accepted_at = vehicle.connection.now()

        def reached() -> bool:
            received_at = vehicle.telemetry.received_at(common.WinchStatus)
            status = vehicle.latest(common.WinchStatus)
            if status is None or received_at is None or received_at <= accepted_at:
                return False
            moves = abs(status.speed) > _STANDSTILL or bool(status.status & _FLAG.MOVING)
            at_end = rate < 0 and bool(status.status & _FLAG.FULLY_RETRACTED)
            return at_end or moves == (rate != 0.0)

        return ActionGoal(reached)

    await _run(vehicle, number, request, goal_of if wait else None, timeout)


async def _run(
    vehicle: Vehicle,
    number: int,
    request: Coroutine[Any, Any, object],
    goal_of: Callable[[common.WinchStatus], ActionGoal | None] | None,
    timeout: float | None,
) -> None:
    """Send a command; with `goal_of`, wait for the goal that it returns for the status before the command."""
    try:
        async with ActionMonitor(vehicle, f"running winch {number} of", timeout, rates={}) as monitor:
            before = None if goal_of is None else await _status(vehicle)
            await with_status_texts(vehicle, request)
            goal = None if before is None or goal_of is None else goal_of(before)
            if goal is not None:
                await monitor.wait_until_reached(goal)
    finally:
        request.close()


async def _status(vehicle: Vehicle) -> common.WinchStatus | None:
    """Return the present status; None if the vehicle does not send it."""
    requested = await vehicle.telemetry.ensure(common.WinchStatus, STATUS_RATE)
    age = vehicle.age(common.WinchStatus)
    if age is not None and age < STATUS_TIMEOUT:
        return vehicle.latest(common.WinchStatus)
    if not requested:
        return None
    async with vehicle.component.stream(common.WinchStatus) as reports:
        try:
            async with asyncio.timeout(STATUS_TIMEOUT):
                return await anext(reports)
        except (TimeoutError, StopAsyncIteration):
            return None
