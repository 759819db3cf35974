"""Behaviours that only ArduPilot has: SmartRTL, landing sequences, Plane's take-off and returns."""

from __future__ import annotations

from math import degrees, dist, hypot, radians, remainder, tau
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours import Land, ReturnToLaunch, Takeoff
from mavstack.sim.autopilot.behaviours.steps import fly_to

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

#: Values of RTL_AUTOLAND: fly the landing sequence after reaching home, or immediately.
_AT_HOME, _IMMEDIATELY = 1, 2
#: Value of Q_RTL_MODE: land on the lifting motors at home.
_HOVER_AT_HOME: Final = 1
_QRTL: Final = int(ardupilotmega.PlaneMode.QRTL)
_MAX_POINTS = 2000
_MIN_SPACING = 1.0
#: The yaw follows a region of interest only if the bearing changes by more than this, in radians.
_MIN_YAW_CHANGE: Final = radians(2)


class ReturnPath:
    """The path flown since arming, without loops, for SMART_RTL; one of the periodic checks."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self.points: list[Point] = []
        #: True if the path exceeded its maximum length and can no longer be flown back.
        self.lost = False
        self._armed = False

    def tick(self, now: float) -> None:
        """Add the present position if it is far enough from the last point."""
        autopilot = self._autopilot
        if autopilot.armed != self._armed:
            self._armed, self.lost = autopilot.armed, False
            self.points = [autopilot.maneuvers.place] if autopilot.armed else []
        returning = isinstance(autopilot.behaviour, SmartReturn)
        if returning or self.lost or not (autopilot.armed and autopilot.has_position):
            return
        here, spacing = autopilot.maneuvers.place, self._spacing
        if not self.points or dist(here, self.points[-1]) >= spacing:
            self._add(here, spacing)

    @property
    def _spacing(self) -> float:
        """Minimum distance between points in metres."""
        return max(2 * float(self._autopilot.vehicle.parameters.get("SRTL_ACCURACY", 2.0)), _MIN_SPACING)

    def _add(self, here: Point, spacing: float) -> None:
        """Add a point, and remove the loop that it closes."""
        loop_start = next(
            (index for index, point in enumerate(self.points) if dist(point, here) < spacing), None
        )
        if loop_start is not None:
            del self.points[loop_start + 1 :]
        self.points.append(here)
        max_points = min(max(int(self._autopilot.vehicle.parameters.get("SRTL_POINTS", 300)), 0), _MAX_POINTS)
        if len(self.points) > max_points:
            self.lost, self.points = True, []
            self._autopilot.vehicle.send_statustext("SmartRTL deactivated: buffer full")


class RegionOfInterestYaw:
    """Turns the nose of a copter or sub to the region of interest in guided flight."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self._active = False

    def tick(self, now: float) -> None:
        """Turn the nose if due; in missions the mission sets the yaw."""
        autopilot, region = self._autopilot, self._autopilot.payload.region_of_interest
        guided = autopilot.armed and autopilot.mode.number == autopilot.profile.guided
        if region is None or not guided:
            if self._active:
                self._active, autopilot.maneuvers.yaw = False, None
            return
        bearing_to_region = autopilot.maneuvers.bearing(region)
        if (
            not self._active
            or abs(remainder(bearing_to_region - (autopilot.maneuvers.yaw or 0.0), tau)) > _MIN_YAW_CHANGE
        ):
            self._active, autopilot.maneuvers.yaw = True, bearing_to_region
            autopilot.maneuvers.reissue()


def return_path_of(autopilot: SimulatedAutopilot) -> ReturnPath | None:
    """Return the vehicle's return path; None if its firmware has none."""
    return next((watch for watch in autopilot.watches if isinstance(watch, ReturnPath)), None)


def land_by_mission(autopilot: SimulatedAutopilot, reason: str) -> bool:
    """Fly the mission's landing sequence; return False if there is none."""
    start = autopilot.mission.landing_start()
    if start is None or not autopilot.has_position:
        return False
    autopilot.mission.go_to_item(start)
    return autopilot.enter(autopilot.profile.mission, reason)


class SmartReturn(Behaviour):
    """SMART_RTL: back along the return path, then land or stop."""

    def fly(self) -> Iterator[None]:
        """Fly home, then hold until the mode changes."""
        autopilot = self.autopilot
        path = return_path_of(autopilot)
        points = path.points if path is not None else []
        while len(points) > 1:
            yield from fly_to(autopilot, points[-1])
            points.pop()
        if autopilot.vehicle.vehicle_type.flies:
            self.landing = True
            yield from Land(autopilot, points[0] if points else None).fly()
        elif points:
            yield from fly_to(autopilot, points[0])
        while True:
            yield


class LandingSequence(Behaviour):
    """AUTO_RTL: continue the mission at its landing sequence; without one, return home."""

    def fly(self) -> Iterator[None]:
        """Fly the landing sequence."""
        mission = self.autopilot.mission
        start = mission.landing_start()
        if start is None:
            yield from mission.leave(self.autopilot.profile.return_to_launch, reason="no landing sequence")
            return
        mission.go_to_item(start)
        yield from mission.fly()


class PlaneReturn(Behaviour):
    """RTL of a plane: circle home, or fly the mission's landing sequence if RTL_AUTOLAND selects it."""

    def fly(self) -> Iterator[None]:
        """Return, then hold until the mode changes."""
        autopilot = self.autopilot
        option = int(autopilot.vehicle.parameters.get("RTL_AUTOLAND", 0))
        sequence = autopilot.mission.landing_start() if option in (_AT_HOME, _IMMEDIATELY) else None
        for _ in ReturnToLaunch(autopilot, forward=True).fly():
            if sequence is not None and (option == _IMMEDIATELY or self._is_home()):
                yield from self._land_by_mission(sequence)
            if self._hovers_at_home() and self._is_home():
                yield from autopilot.mission.leave(_QRTL, reason="home is reached")
            yield

    def _land_by_mission(self, sequence: int) -> Iterator[None]:
        """Change to the landing sequence."""
        autopilot = self.autopilot
        autopilot.mission.go_to_item(sequence)
        yield from autopilot.mission.leave(autopilot.profile.mission, reason="landing sequence")

    def _hovers_at_home(self) -> bool:
        """Return whether Q_RTL_MODE lands on the lifting motors."""
        return int(self.autopilot.vehicle.parameters.get("Q_RTL_MODE", 0)) == _HOVER_AT_HOME

    def _is_home(self) -> bool:
        """Return whether home is near."""
        autopilot = self.autopilot
        near = abs(autopilot.flight_parameters.loiter_radius) * 1.5
        return autopilot.maneuvers.distance(autopilot.rally.destination()) <= near


class QuadplaneReturn(ReturnToLaunch):
    """QRTL: home, on the wing while it is far, and down on the lifting motors."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        near = abs(autopilot.flight_parameters.loiter_radius) * 1.5
        far = autopilot.maneuvers.distance(autopilot.home_position) > near
        super().__init__(autopilot, forward=far and autopilot.body.flies_forward)


class PlaneTakeoff(Behaviour):
    """TAKEOFF: climb to TKOFF_ALT and circle there."""

    def fly(self) -> Iterator[None]:
        """Take off, then circle until the mode changes."""
        autopilot = self.autopilot
        if not autopilot.landed:
            autopilot.maneuvers.hold()
        else:
            altitude = self._altitude()
            takeoff = Takeoff(autopilot, altitude, forward=True)
            self._send_statustext(altitude)
            for _ in takeoff.fly():
                self.taking_off = takeoff.taking_off
                yield
            self.taking_off = False
        while True:
            yield

    def _send_statustext(self, altitude: float) -> None:
        """Report the take-off."""
        vehicle, here = self.autopilot.vehicle, self.autopilot.body.estimate
        speed = hypot(here.velocity_north, here.velocity_east)
        distance = float(vehicle.parameters.get("TKOFF_DIST", 200.0))
        heading = degrees(here.yaw) % 360
        vehicle.send_statustext(f"Triggered AUTO. GPS speed = {speed:.1f}")
        vehicle.send_statustext(f"Takeoff to {altitude:.0f}m for {distance:.1f}m heading {heading:.1f} deg")

    def _altitude(self) -> float:
        """Return the altitude of take-off in metres."""
        return max(float(self.autopilot.vehicle.parameters.get("TKOFF_ALT", 50.0)), 5.0)
