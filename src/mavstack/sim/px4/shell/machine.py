"""What a program of the shell works on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.px4.shell.journal import Journal
    from mavstack.sim.px4.state import Px4State


@dataclass(frozen=True, slots=True)
class Machine:
    """One vehicle, as its shell reaches it."""

    vehicle: Vehicle
    state: Px4State
    journal: Journal
