"""GPS Rescue of Betaflight: climb, fly home, descend and land, then disarm."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, Final

from mavstack.msp.messages.gps import GpsRescue
from mavstack.sim.msp import scripts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.msp.system import System


#: Distance from home in metres within which the vehicle lands at its present position.
LANDING_RADIUS: Final = 5.0
_LANDING_ALTITUDE: Final = 5.0
_ASCEND, _DESCEND = 7.5, 1.5


def rescue(controller: System) -> Iterator[None]:
    """Return home and land."""
    body, settings = controller.body, controller.settings.get(GpsRescue)
    home = controller.home or body.estimate[:2]
    ground = body.estimate.down + controller.altitude
    here = body.estimate
    ascend, descend = settings.ascend_rate or _ASCEND, settings.descend_rate or _DESCEND
    if hypot(here.north - home[0], here.east - home[1]) > LANDING_RADIUS:
        down = min(here.down, ground - settings.return_altitude)
        yield from scripts.climb_to(body, down, climb=ascend)
        yield from scripts.fly_to(
            body, (home[0], home[1], down), speed=settings.ground_speed, climb=ascend, radius=LANDING_RADIUS
        )
    speeds = scripts.LandingSpeeds(descend, min(descend, 1.0), _LANDING_ALTITUDE)
    yield from scripts.land(body, speeds, (home[0], home[1]))
    controller.arming.disarm("GPS rescue")
