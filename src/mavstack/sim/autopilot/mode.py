"""A flight mode of a simulated firmware: its number and name, what it needs, what it does, what follows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.modes import AvailableMode
    from mavstack.sim.autopilot.autopilot import Autopilot
    from mavstack.sim.autopilot.behaviour import Behaviour

_FLAGS = common.MavModeFlag


@dataclass(frozen=True, slots=True)
class Mode:
    """One mode; `then` is the `custom_mode` that follows when its behaviour ends, None if it stays."""

    available: AvailableMode
    behaviour: Callable[[Autopilot], Behaviour]
    #: HEARTBEAT's `base_mode` without the armed and custom bits.
    flags: int = _FLAGS.STABILIZE_ENABLED
    needs_position: bool = True
    #: Whether the pilot's sticks fly it, so that it cannot go on without them.
    by_hand: bool = False
    #: Whether the motors may be armed in it.
    may_arm: bool = True
    then: int | None = None
    #: Its name, where AVAILABLE_MODES tells none because it is a standard mode.
    label: str = ""

    @property
    def number(self) -> int:
        """HEARTBEAT's `custom_mode`."""
        return self.available.custom_mode

    @property
    def name(self) -> str:
        """As its firmware calls it."""
        return self.label or self.available.name
