"""Long commands: scripts that run with the ticks of the autopilot.

A script is a generator. It yields its progress in percent, or None, and returns its MAV_RESULT. While it runs
the sender gets IN_PROGRESS, at most twice a second, and may cancel it.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.services.command import CommandCancelRequested

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from mavstack.services.command import CommandRequest
    from mavstack.sim.vehicle import SimulatedVehicle

#: Minimum interval between two progress reports of a command, in seconds.
PROGRESS_INTERVAL = 0.5

Script: TypeAlias = "Generator[int | None, None, common.MavResult]"


class Tasks:
    """The long commands of one vehicle; one of its autopilot's watches."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._scripts: dict[CommandRequest, Script] = {}
        self._reported_at: dict[CommandRequest, float] = {}
        self._unanswered: list[Script] = []
        self._afterwards: Callable[[], None] | None = None
        vehicle.on_event(CommandCancelRequested, self._cancelled)

    def begin(self, request: CommandRequest, script: Script) -> None:
        """Run a script until it ends; the handler that calls this returns None."""
        self._scripts[request] = script

    def run(self, script: Script) -> None:
        """Run a script without a command to answer, such as one that was acknowledged immediately."""
        self._unanswered.append(script)

    def on_next_tick(self, action: Callable[[], None]) -> None:
        """Call `action` in the next tick, when the pending answer has been sent."""
        self._afterwards = action

    def tick(self, now: float) -> None:
        """Advance every script by one step."""
        action, self._afterwards = self._afterwards, None
        if action is not None:
            action()
            return
        self._unanswered = [script for script in self._unanswered if next(script, _ENDED) is not _ENDED]
        for request, script in tuple(self._scripts.items()):
            try:
                percent = next(script)
            except StopIteration as ended:
                self._end(request, ended.value)
                continue
            reported_at = self._reported_at.get(request, -inf)
            if percent not in (None, request.percent) and now - reported_at >= PROGRESS_INTERVAL:
                self._reported_at[request] = now
                self._vehicle.commands.progress(request, percent, now)
                self._vehicle.touch(self._vehicle.commands)

    def _cancelled(self, event: CommandCancelRequested) -> None:
        script = self._scripts.get(event.request)
        if script is not None:
            script.close()
            self._end(event.request, common.MavResult.CANCELLED)

    def _end(self, request: CommandRequest, result: common.MavResult) -> None:
        del self._scripts[request]
        self._reported_at.pop(request, None)
        self._vehicle.commands.complete(request, result)
        self._vehicle.touch(self._vehicle.commands)


_ENDED = object()
