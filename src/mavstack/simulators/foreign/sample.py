"""A sample of another simulator: the body at one time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.rotation import Quaternion, Vector


@dataclass(frozen=True, slots=True)
class ForeignSample:
    """The body at one time.

    Attributes:
        time: Seconds of the simulation.
        position: Metres north, east, down of home.
        velocity: Metres per second north, east, down.
        attitude: From body axes to north, east, down.
        rates: rad/s about the body axes.
        force: Specific force in body axes in m/s2.
    """

    time: float
    position: Vector
    velocity: Vector
    attitude: Quaternion
    rates: Vector
    force: Vector
