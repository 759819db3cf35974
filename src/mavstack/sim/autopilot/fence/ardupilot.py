"""ArduPilot's fences: FENCE_ENABLE, FENCE_TYPE, FENCE_ACTION and related parameters.

Copter, Plane, Rover and Sub share the limits and differ in the meaning of FENCE_ACTION. A plane flies to the
fence's return point, the nearest rally point or the middle of the fence, in GUIDED. A copter that is far
beyond its fence lands there.
"""

from __future__ import annotations

from math import inf, isnan
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.fence.rules import FenceRules
from mavstack.sim.autopilot.fence_limits import Breach, FenceLimits
from mavstack.sim.autopilot.fence_shapes import Polygon
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.fence import FenceWatch
    from mavstack.sim.autopilot.maneuvers import Point

_NAMES: Final[Mapping[Breach, str]] = {
    Breach.HIGH: "Max Alt",
    Breach.RADIUS: "Circle",
    Breach.SHAPES: "Polygon",
    Breach.LOW: "Min Alt",
}
#: Distance in metres beyond the fence at which a copter lands at once.
_GIVE_UP = 100.0
_UNION_OPTION = 2
_REPORT = 0
_PLANE_GUIDED = frozenset({6, 7})
#: Names of the modes to try in turn, by vehicle type and the value of FENCE_ACTION.
_ACTIONS: Final[Mapping[VehicleType, Mapping[int, tuple[str, ...]]]] = {
    VehicleType.COPTER: {
        1: ("RTL", "LAND"),
        2: ("LAND",),
        3: ("SMART_RTL", "RTL", "LAND"),
        4: ("BRAKE", "LAND"),
        5: ("SMART_RTL", "LAND"),
    },
    VehicleType.PLANE: {1: ("RTL",), 6: ("GUIDED",), 7: ("GUIDED",), 8: ("AUTOLAND", "RTL")},
    VehicleType.VTOL: {1: ("RTL",), 6: ("GUIDED",), 7: ("GUIDED",), 8: ("AUTOLAND", "RTL")},
    VehicleType.ROVER: {
        1: ("RTL", "HOLD"),
        2: ("HOLD",),
        3: ("SMART_RTL", "RTL", "HOLD"),
        4: ("SMART_RTL", "HOLD"),
    },
    VehicleType.SUB: {1: ("SURFACE",)},
}
_NOTICE = common.MavSeverity.NOTICE


class ArdupilotFenceRules(FenceRules):
    """The fence rules of Copter, Plane, Rover and Sub."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        super().__init__(autopilot)
        self._enable: float | None = None

    def limits(self, watch: FenceWatch) -> FenceLimits:
        self._apply_switch(watch)
        on = self.number("FENCE_ENABLE") > 0 if watch.switched is None else watch.switched
        if not on:
            return FenceLimits()
        watched = Breach(int(self.number("FENCE_TYPE", 7)) & 15)
        if watch.floor_off or not self.vehicle.vehicle_type.flies:
            watched &= ~Breach.LOW
        if not self.vehicle.vehicle_type.flies:
            watched &= ~Breach.HIGH
        return FenceLimits(
            watched,
            highest=self.number("FENCE_ALT_MAX", inf),
            lowest=self.number("FENCE_ALT_MIN", -inf),
            radius=self.number("FENCE_RADIUS", inf),
            union=bool(int(self.number("FENCE_OPTIONS")) & _UNION_OPTION),
        )

    def _apply_switch(self, watch: FenceWatch) -> None:
        """Let a newly set FENCE_ENABLE override an earlier command."""
        before, self._enable = self._enable, self.number("FENCE_ENABLE")
        if before is not None and before != self._enable:
            watch.reset_switch()

    def breached(self, watch: FenceWatch, new: Breach) -> None:
        autopilot = self.autopilot
        if not autopilot.landed or not self.vehicle.vehicle_type.flies:
            self.vehicle.send_statustext(f"{names_of(new)} breached", _NOTICE)
        action = int(self.number("FENCE_ACTION"))
        if action == _REPORT or (autopilot.behaviour is not None and autopilot.behaviour.landing):
            return
        if autopilot.landed and self.vehicle.vehicle_type is VehicleType.COPTER:
            autopilot.disarm("fence breach")
        elif self.vehicle.vehicle_type is VehicleType.COPTER and watch.breach_distance() > _GIVE_UP:
            self._enter(("LAND",))
        else:
            self._act(watch, action)

    def worsened(self, watch: FenceWatch) -> None:
        self.breached(watch, watch.breaches)

    def cleared(self, watch: FenceWatch) -> None:
        self.vehicle.send_statustext("Fence breach cleared", _NOTICE)

    def replaced(self, watch: FenceWatch) -> None:
        if watch.fence.shapes:
            self.vehicle.send_statustext("Fence received")

    def problems(self, watch: FenceWatch) -> Iterator[str]:
        if not watch.enabled:
            return
        if watch.breaches:
            yield f"Vehicle breaching {names_of(watch.breaches)}"
        limits = watch.limits
        if limits.watched & Breach.RADIUS and limits.radius < 0:
            yield "Invalid FENCE_RADIUS value"
        if limits.watched & Breach.HIGH and limits.highest < 0:
            yield "Invalid FENCE_ALT_MAX value"

    def _act(self, watch: FenceWatch, action: int) -> None:
        kind = VehicleType.ROVER if self.vehicle.vehicle_type.on_surface else self.vehicle.vehicle_type
        names = _ACTIONS[kind].get(action, ())
        if self._enter(names) and action in _PLANE_GUIDED and kind in {VehicleType.PLANE, VehicleType.VTOL}:
            self.autopilot.guided.go_to(self.return_point(watch))

    def _enter(self, names: tuple[str, ...]) -> bool:
        profile = self.autopilot.profile
        modes = {mode.name.replace("_", "").upper(): mode.number for mode in profile.modes}
        modes |= {"RTL": profile.return_to_launch, "GUIDED": profile.guided, "HOLD": profile.hold}
        modes.setdefault("LAND", profile.land)
        for name in names:
            number = modes.get(name.replace("_", ""))
            if number is not None and self.autopilot.enter(number, "fence breached"):
                return True
        return False

    def return_point(self, watch: FenceWatch) -> Point:
        """Return a plane's target: a rally point (FENCE_RET_RALLY), the return point, the middle, or home."""
        autopilot = self.autopilot
        rally = autopilot.rally.nearest() if self.number("FENCE_RET_RALLY") else None
        altitude = self._return_altitude(watch)
        down = autopilot.home_position[2] - altitude
        point = watch.fence.return_point
        if rally is not None:
            return rally
        if point is not None:
            return point[0], point[1], down if isnan(point[2]) else point[2]
        inside = (shape for shape in watch.fence.shapes if shape.inclusion and isinstance(shape, Polygon))
        middle = next(inside, None)
        if middle is None:
            return autopilot.home_position[0], autopilot.home_position[1], down
        norths, easts = zip(*middle.corners, strict=True)
        return sum(norths) / len(norths), sum(easts) / len(easts), down

    def _return_altitude(self, watch: FenceWatch) -> float:
        wanted = self.number("FENCE_RET_ALT")
        if wanted > 0:
            return wanted
        limits = watch.limits
        if abs(limits.highest) < inf and abs(limits.lowest) < inf and limits.highest > limits.lowest:
            return (limits.highest + limits.lowest) / 2
        return self.autopilot.flight_parameters.return_altitude


def names_of(breaches: Breach) -> str:
    """Return the text of breaches in STATUSTEXT, such as "Max Alt and Circle fences"."""
    names = [name for bit, name in _NAMES.items() if breaches & bit]
    listed = ", ".join(names[:-1]) + (" and " if len(names) > 1 else "") + "".join(names[-1:])
    return f"{listed} fence{'s' if len(names) > 1 else ''}"
