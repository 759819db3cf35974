"""How commands reach the autopilot: groups of handlers, of which a firmware takes those that it has.

A group is a class with a method for each command, shared by both firmwares; where one behaves in its own way,
it overrides the method. `handlers` names the methods by MAV_CMD, and a profile registers them:

    take(vehicle, MovementCommands(vehicle).handlers())

A handler gives its MAV_RESULT, or None if it began a long command (`tasks.py`), or it raises
`CommandRefusedError`. What comes in a parameter is never trusted: `whole` and `number` read it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from math import isfinite
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.sim.autopilot.commands.refusal import CommandRefusedError

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.services.command.server import Handler
    from mavstack.sim.autopilot.commands.tasks import Script
    from mavstack.sim.autopilot.interfaces import Autopilot, Vehicle

#: What a group's method gives; None: it is a long command that has begun.
Outcome: TypeAlias = "common.MavResult | None"
Handlers: TypeAlias = Mapping[int, "Callable[[CommandRequest], Outcome]"]

_LARGEST = 1 << 32


class CommandGroup(ABC):
    """Some commands of one vehicle."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle

    @property
    def autopilot(self) -> Autopilot:
        """The vehicle's autopilot."""
        return self.vehicle.autopilot

    @abstractmethod
    def handlers(self) -> Handlers:
        """The commands of the group, and what carries out each."""

    def enter(self, mode: int) -> common.MavResult:
        """Enter a mode because a command said so: FAILED, and why, if it cannot be."""
        found = self.autopilot.find_mode(mode)
        if found is None:
            return common.MavResult.UNSUPPORTED
        refused = self.autopilot.may_enter(found.available, self.vehicle.address)
        if refused is not None:
            raise CommandRefusedError(common.MavResult.FAILED, refused)
        entered = self.autopilot.enter(mode, "commanded", commanded=True)
        return common.MavResult.ACCEPTED if entered else common.MavResult.FAILED


def take(vehicle: Vehicle, handlers: Handlers) -> None:
    """Carry out commands by these handlers from now on."""
    for command, handler in handlers.items():
        vehicle.commands.support(command, _guarded(vehicle, handler))


def waiting(vehicle: Vehicle, seconds: float) -> Script:
    """Return a script that waits for some seconds and reports its progress in percent."""
    begun = vehicle.autopilot.now
    while (passed := vehicle.autopilot.now - begun) < seconds:
        yield min(int(passed / seconds * 100), 99)
    return common.MavResult.ACCEPTED


def accept(done: bool) -> common.MavResult:
    """ACCEPTED if it was done, else FAILED."""
    return common.MavResult.ACCEPTED if done else common.MavResult.FAILED


def whole(value: float) -> int | None:
    """A parameter as a whole number; None if it is none."""
    return int(value) if isfinite(value) and abs(value) < _LARGEST and value == int(value) else None


def needed(value: float) -> int:
    """A parameter as a whole number; DENIED if it is none."""
    found = whole(value)
    if found is None:
        raise CommandRefusedError(common.MavResult.DENIED)
    return found


def number(value: float, default: float = 0.0) -> float:
    """A parameter, or what it means if it is left out as NaN."""
    return value if isfinite(value) else default


def _guarded(vehicle: Vehicle, handler: Callable[[CommandRequest], Outcome]) -> Handler:
    def carry_out(request: CommandRequest) -> Outcome:
        try:
            return handler(request)
        except CommandRefusedError as refused:
            if refused.text:
                vehicle.send_statustext(refused.text, common.MavSeverity.WARNING)
            return refused.result

    return carry_out
