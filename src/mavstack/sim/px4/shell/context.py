"""The objects that programs of the shell use."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.sim.px4.shell.message_log import MessageLog
    from mavstack.sim.px4.state import Px4State
    from mavstack.sim.vehicle import SimulatedVehicle


@dataclass(frozen=True, slots=True)
class ShellContext:
    """One vehicle as seen by its shell."""

    vehicle: SimulatedVehicle
    state: Px4State
    message_log: MessageLog
