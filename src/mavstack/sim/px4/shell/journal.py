"""What the vehicle said since its last boot, for `dmesg`."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Vehicle

_MOST: Final = 200


class Journal:
    """Remembers texts; the oldest are forgotten."""

    def __init__(self) -> None:
        self.lines: deque[str] = deque(maxlen=_MOST)

    def begin(self, vehicle: Vehicle) -> None:
        """Forget, and listen to a vehicle, once however often it boots."""
        self.lines.clear()
        vehicle.add_listener(self.told)

    def told(self, vehicle: Vehicle, kind: str, text: str) -> None:
        """The vehicle said or did something."""
        if kind == "text":
            self.lines.append(f"[{vehicle.uptime:10.3f}] INFO  [commander] {text}")
