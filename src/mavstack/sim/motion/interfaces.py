"""The world as its bodies see it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from mavstack.sim.motion.sensors import Sensors
    from mavstack.sim.motion.state import StateArray


class BodyWorld(Protocol):
    """The world that holds the state of all bodies, one column per body; see `World`."""

    state: StateArray
    sensors: Sensors
    #: The number of steps so far.
    tick: int

    def sensor_values(self, column: int) -> list[float]:
        """Return the readings of one body's sensors in this step."""

    def place(self, column: int, place: tuple[float, float, float], yaw: float) -> None:
        """Move one body and its estimate to a position, at rest and level."""

    def set_wind(self, speed: float, direction: float = 0.0, turbulence: float = 0.0) -> None:
        """Set the mean wind."""
