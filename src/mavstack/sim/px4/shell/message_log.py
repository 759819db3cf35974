"""Status texts since the last boot, for `dmesg`."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle

_MAX_LINES: Final = 200


class MessageLog:
    """A log of the last status texts."""

    def __init__(self) -> None:
        self.lines: deque[str] = deque(maxlen=_MAX_LINES)

    def start(self, vehicle: SimulatedVehicle) -> None:
        """Clear the log at boot, and listen to the vehicle."""
        self.lines.clear()
        vehicle.add_listener(self.on_event)

    def on_event(self, vehicle: SimulatedVehicle, event: str, text: str) -> None:
        """Append a status text of the vehicle."""
        if event == "text":
            self.lines.append(f"[{vehicle.uptime:10.3f}] INFO  [commander] {text}")
