"""PX4's two take-offs: to the altitude that the command gave, or else by MIS_TAKEOFF_ALT.

The command may come before or after arming; what it said waits in the state until the mode is flown.
"""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.behaviours import Takeoff
from mavstack.sim.autopilot.behaviours.steps import wait

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.px4.state import Px4State


class Px4Takeoff(Takeoff):
    """Straight up, or as a wing does; never down. `forward`: a VTOL flies on with its wing."""

    def __init__(self, autopilot: Autopilot, state: Px4State, *, forward: bool = False) -> None:
        super().__init__(autopilot, forward=forward)
        self._state = state

    def fly(self) -> Iterator[None]:
        """Until it is up; first the motors spin up."""
        self._down = self._chosen()
        if self.autopilot.landed:
            self.autopilot.body.idle()
            yield from wait(self.autopilot, float(self.autopilot.vehicle.parameters["COM_SPOOLUP_TIME"]))
        yield from super().fly()

    def _chosen(self) -> float:
        """As high as it was told, in local metres."""
        autopilot, send_statustext = self.autopilot, self.autopilot.vehicle.send_statustext
        here = autopilot.maneuvers.place[2]
        altitude, self._state.takeoff_altitude = self._state.takeoff_altitude, None
        if altitude is None or not isfinite(altitude):
            height = autopilot.flight_parameters.takeoff_altitude
            send_statustext(f"Using default takeoff altitude: {height:.1f} m")
            return here - height
        down = autopilot.body.frame.altitude - altitude
        if down > here:
            send_statustext("Already higher than takeoff altitude", common.MavSeverity.CRITICAL)
        return min(down, here)
