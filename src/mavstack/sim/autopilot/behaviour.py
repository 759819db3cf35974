"""The behaviour of a vehicle in a mode, as a script.

`fly` is a generator: the code before a `yield` runs in one tick of the autopilot, ten times a second. When it
returns, the behaviour is complete and the mode names its successor. Leaving a mode closes the generator, so
that a `finally` cleans up. Waiting is a loop with a `yield` in it:

    autopilot.maneuvers.hold(point)
    while not autopilot.maneuvers.is_at_altitude(point[2]):
        yield

The scripts serve all firmwares and vehicle types: speeds and altitudes come from
`autopilot.flight_parameters`, the ways to hold a position and to follow a line from `autopilot.maneuvers`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


class Behaviour(ABC):
    """One script, started when its mode is entered."""

    #: True during a takeoff or a landing; MAV_LANDED_STATE is derived from these flags.
    taking_off = False
    landing = False
    #: True if the behaviour follows SET_POSITION_TARGET_* and SET_ATTITUDE_TARGET.
    takes_setpoints = False

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self.autopilot = autopilot

    @abstractmethod
    def fly(self) -> Iterator[None]:
        """Run the behaviour, one `yield` per tick."""
