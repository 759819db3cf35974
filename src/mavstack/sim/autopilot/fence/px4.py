"""PX4's fences: GF_ACTION, GF_MAX_HOR_DIST, GF_MAX_VER_DIST, and the plan.

A plan that excludes the vehicle or its home is reported as invalid at the upload. Being inside any of the
inclusions is enough.
"""

from __future__ import annotations

from enum import IntEnum
from math import inf
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.fence.rules import FenceRules
from mavstack.sim.autopilot.fence_limits import Breach, FenceLimits

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.sim.autopilot.fence import FenceWatch


_CRITICAL = common.MavSeverity.CRITICAL


class GeofenceAction(IntEnum):
    """GF_ACTION."""

    NONE = 0
    WARN = 1
    HOLD = 2
    RETURN = 3
    TERMINATE = 4
    LAND = 5


_TEXTS: Final[Mapping[Breach, str]] = {
    Breach.RADIUS: "Geofence: exceeding maximum distance to Home",
    Breach.HIGH: "Geofence: exceeding maximum altitude above Home",
    Breach.SHAPES: "Geofence: approaching or outside geofence",
}


class Px4FenceRules(FenceRules):
    """The fence rules of PX4."""

    def limits(self, watch: FenceWatch) -> FenceLimits:
        action = int(self.number("GF_ACTION", GeofenceAction.HOLD))
        if action == GeofenceAction.NONE or watch.switched is False:
            return FenceLimits()
        radius, height = self.number("GF_MAX_HOR_DIST"), self.number("GF_MAX_VER_DIST")
        watched = Breach.SHAPES
        watched |= Breach.RADIUS if radius > 0 else Breach.NONE
        watched |= Breach.HIGH if height > 0 else Breach.NONE
        return FenceLimits(
            watched, highest=height if height > 0 else inf, radius=radius if radius > 0 else inf, union=True
        )

    def breached(self, watch: FenceWatch, new: Breach) -> None:
        for bit, text in _TEXTS.items():
            if new & bit:
                self.vehicle.send_statustext(text, _CRITICAL)
        autopilot = self.autopilot
        if autopilot.landed:
            return
        match int(self.number("GF_ACTION", GeofenceAction.HOLD)):
            case GeofenceAction.HOLD:
                autopilot.enter(autopilot.profile.hold, "geofence")
            case GeofenceAction.RETURN:
                autopilot.enter(autopilot.profile.return_to_launch, "geofence")
            case GeofenceAction.LAND:
                autopilot.enter(autopilot.profile.land, "geofence")
            case GeofenceAction.TERMINATE:
                autopilot.terminate()

    def problems(self, watch: FenceWatch) -> Iterator[str]:
        for bit, text in _TEXTS.items():
            if watch.breaches & bit:
                yield text

    def replaced(self, watch: FenceWatch) -> None:
        autopilot = self.autopilot
        if not watch.fence.shapes or not autopilot.has_position:
            return
        home, here = autopilot.home_position, autopilot.maneuvers.place
        if autopilot.home is not None and not watch.fence.permits(home[:2], union=True):
            self.vehicle.send_statustext("Geofence invalid, doesn't contain Home position", _CRITICAL)
        elif not watch.fence.permits(here[:2], union=True):
            self.vehicle.send_statustext(
                "Geofence invalid, doesn't contain current vehicle position", _CRITICAL
            )
