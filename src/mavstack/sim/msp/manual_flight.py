"""Flight by the pilot's sticks: acro, angle and horizon mode.

In acro mode the sticks demand turn rates, in angle mode roll and pitch. Horizon mode is angle mode around
the middle of the sticks, and acro mode near their ends. The throttle is the thrust in all three; half of it
hovers.
"""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from mavstack.sim.motion import Body
    from mavstack.sim.msp.receiver import Sticks

#: Deflection of a stick (0 to 1) beyond which horizon mode behaves as acro mode.
HORIZON_SHARE: Final = 0.75
#: The thrust (0 to 1) of idling motors in the air.
IDLE_THRUST: Final = 0.05


class ManualFlight:
    """Flight by the sticks.

    Args:
        body: The body.
        rates: The turn rates of roll, pitch and yaw in degrees per second, by the positions of the sticks.
    """

    def __init__(
        self, body: Body, rates: Callable[[float, float, float], tuple[float, float, float]]
    ) -> None:
        self._body, self._rates = body, rates

    def fly(self, sticks: Sticks, modes: Collection[str], angle_limit: float) -> None:
        """Fly one step.

        Args:
            sticks: The positions of the sticks.
            modes: The active modes: "ANGLE", "HORIZON"; acro mode without them.
            angle_limit: Roll and pitch at full stick in angle mode, in degrees.
        """
        body = self._body
        if body.on_ground and sticks.throttle <= 0.0:
            body.idle()
            return
        thrust = max(sticks.throttle, IDLE_THRUST)
        roll_rate, pitch_rate, yaw_rate = (
            radians(rate) for rate in self._rates(sticks.roll, sticks.pitch, sticks.yaw)
        )
        if self._levels(sticks, modes):
            limit = radians(angle_limit)
            body.hold_attitude(sticks.roll * limit, -sticks.pitch * limit, None, thrust, yaw_rate=yaw_rate)
        else:
            body.hold_rates(roll_rate, -pitch_rate, yaw_rate, thrust)

    @staticmethod
    def _levels(sticks: Sticks, modes: Collection[str]) -> bool:
        """Return whether roll and pitch are demanded as angles."""
        if "ANGLE" in modes:
            return True
        return "HORIZON" in modes and max(abs(sticks.roll), abs(sticks.pitch)) < HORIZON_SHARE
