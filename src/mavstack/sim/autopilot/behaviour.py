"""What a vehicle does in a mode, as a script.

`fly` is a generator: what stands before a `yield` is done in one tick of the autopilot, ten times a second;
when it returns, the behaviour has reached its end and the mode says what follows. Leaving a mode closes the
generator, so that a `finally` tidies up. Waiting is a loop with a `yield` in it:

    autopilot.maneuvers.climb_to(altitude)
    while not autopilot.maneuvers.is_at_altitude(altitude):
        yield

The same scripts serve both firmwares and all types: flight parameters come from `autopilot.flight_parameters`, and how a type
holds a place or follows a line is in `autopilot.maneuvers`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot


class Behaviour(ABC):
    """One script, begun when its mode is entered."""

    #: MAV_LANDED_STATE of what it does besides staying in the air.
    taking_off = False
    landing = False
    #: Whether what comes by SET_POSITION_TARGET_* and SET_ATTITUDE_TARGET is followed.
    takes_setpoints = False

    def __init__(self, autopilot: Autopilot) -> None:
        self.autopilot = autopilot

    @abstractmethod
    def fly(self) -> Iterator[None]:
        """Do it, a tick at a time."""
