"""The behaviour of the mission mode: it flies `autopilot.mission`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour

if TYPE_CHECKING:
    from collections.abc import Iterator


class Mission(Behaviour):
    """Fly the mission."""

    def fly(self) -> Iterator[None]:
        """Run until the mode is left."""
        return self.autopilot.mission.fly()

    @property
    def taking_off(self) -> bool:  # type: ignore[override]
        """True while an item takes off."""
        part = self.autopilot.mission.part
        return part is not None and part.taking_off

    @property
    def landing(self) -> bool:  # type: ignore[override]
        """True while an item lands."""
        part = self.autopilot.mission.part
        return part is not None and part.landing

    @property
    def takes_setpoints(self) -> bool:  # type: ignore[override]
        """True while an item follows setpoints."""
        part = self.autopilot.mission.part
        return part is not None and part.takes_setpoints
