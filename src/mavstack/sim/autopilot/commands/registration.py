"""Command handlers of the autopilot, in groups that each firmware registers.

A group is a class with a method for each command, shared by both firmwares; a firmware overrides the methods
that differ. `handlers` lists the methods by MAV_CMD, and a profile registers them:

    register_handlers(vehicle, MovementCommands(vehicle).handlers())

A handler returns its MAV_RESULT, or None if it began a long command (`autopilot/tasks.py`), or it raises
`CommandRefusedError`. Params are never trusted: `whole` and `number` validate them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from math import isfinite
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.sim.autopilot.refusal import CommandRefusedError

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.services.command.server import Handler
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.tasks import Script
    from mavstack.sim.vehicle import SimulatedVehicle

#: The result of a command handler; None if a long-running command has begun.
Outcome: TypeAlias = "common.MavResult | None"
Handlers: TypeAlias = Mapping[int, "Callable[[CommandRequest], Outcome]"]

_LARGEST = 1 << 32


class CommandGroup(ABC):
    """Some commands of one vehicle."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self.vehicle = vehicle

    @property
    def autopilot(self) -> SimulatedAutopilot:
        """The vehicle's autopilot."""
        return self.vehicle.autopilot

    @abstractmethod
    def handlers(self) -> Handlers:
        """Return the handlers of the group by MAV_CMD."""

    def enter(self, mode: int) -> common.MavResult:
        """Enter a mode for a command; raises CommandRefusedError with FAILED and the reason."""
        found = self.autopilot.find_mode(mode)
        if found is None:
            return common.MavResult.UNSUPPORTED
        refused = self.autopilot.may_enter(found.available, self.vehicle.address)
        if refused is not None:
            raise CommandRefusedError(common.MavResult.FAILED, refused)
        entered = self.autopilot.enter(mode, "commanded", commanded=True)
        return common.MavResult.ACCEPTED if entered else common.MavResult.FAILED


def register_handlers(vehicle: SimulatedVehicle, handlers: Handlers) -> None:
    """Register the handlers of commands."""
    for command, handler in handlers.items():
        vehicle.commands.support(command, _guarded(vehicle, handler))


def waiting(vehicle: SimulatedVehicle, seconds: float) -> Script:
    """Return a script that waits for some seconds and reports its progress in percent."""
    begun = vehicle.autopilot.now
    while (passed := vehicle.autopilot.now - begun) < seconds:
        yield min(int(passed / seconds * 100), 99)
    return common.MavResult.ACCEPTED


def accept(done: bool) -> common.MavResult:
    """Return ACCEPTED or FAILED."""
    return common.MavResult.ACCEPTED if done else common.MavResult.FAILED


def whole(value: float) -> int | None:
    """Return a param as an integer; None if it is no whole number."""
    return int(value) if isfinite(value) and abs(value) < _LARGEST and value == int(value) else None


def required_whole(value: float) -> int:
    """Return a param as an integer; raises CommandRefusedError with DENIED if it is no whole number."""
    found = whole(value)
    if found is None:
        raise CommandRefusedError(common.MavResult.DENIED)
    return found


def number(value: float, default: float = 0.0) -> float:
    """Return a param; `default` if it is NaN."""
    return value if isfinite(value) else default


def _guarded(vehicle: SimulatedVehicle, handler: Callable[[CommandRequest], Outcome]) -> Handler:
    def carry_out(request: CommandRequest) -> Outcome:
        try:
            return handler(request)
        except CommandRefusedError as refused:
            if refused.text:
                vehicle.send_statustext(refused.text, common.MavSeverity.WARNING)
            return refused.result

    return carry_out
