"""What only ArduPilot's vehicles do: come back the way they came, land by the mission, take off on a wing."""

from __future__ import annotations

from math import degrees, dist, hypot, radians, remainder, tau
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours import Land, ReturnToLaunch, Takeoff
from mavstack.sim.autopilot.behaviours.steps import fly_to

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.autopilot.maneuvers import Point

#: RTL_AUTOLAND: by the mission's landing sequence when home is reached, or at once.
_AT_HOME, _AT_ONCE = 1, 2
#: Q_RTL_MODE: land on the lifting motors when home is reached.
_HOVER_AT_HOME: Final = 1
_QRTL: Final = int(ardupilotmega.PlaneMode.QRTL)
_MOST_POINTS = 2000
_LEAST_SPACING = 1.0
#: The nose follows a region of interest in steps of so many radians.
_TURN: Final = radians(2)


class Trail:
    """The way that the vehicle came since it was armed, loops cut off; one of its autopilot's watches."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self.points: list[Point] = []
        #: Whether the way became longer than there is room for.
        self.lost = False
        self._armed = False

    def tick(self, now: float) -> None:
        """Note where it is, if it is somewhere else than before."""
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
        return max(2 * float(self._autopilot.vehicle.parameters.get("SRTL_ACCURACY", 2.0)), _LEAST_SPACING)

    def _add(self, here: Point, spacing: float) -> None:
        known = next((index for index, point in enumerate(self.points) if dist(point, here) < spacing), None)
        if known is not None:
            del self.points[known + 1 :]
        self.points.append(here)
        most = min(max(int(self._autopilot.vehicle.parameters.get("SRTL_POINTS", 300)), 0), _MOST_POINTS)
        if len(self.points) > most:
            self.lost, self.points = True, []
            self._autopilot.vehicle.send_statustext("SmartRTL deactivated: buffer full")


class NoseWatch:
    """Turns a copter's or sub's nose to the region of interest while it flies to what it is told."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self._turned = False

    def tick(self, now: float) -> None:
        """Look, and turn; the mission does that itself."""
        autopilot, region = self._autopilot, self._autopilot.payload.region_of_interest
        guided = autopilot.armed and autopilot.mode.number == autopilot.profile.guided
        if region is None or not guided:
            if self._turned:
                self._turned, autopilot.maneuvers.yaw = False, None
            return
        wanted = autopilot.maneuvers.bearing(region)
        if not self._turned or abs(remainder(wanted - (autopilot.maneuvers.yaw or 0.0), tau)) > _TURN:
            self._turned, autopilot.maneuvers.yaw = True, wanted
            autopilot.maneuvers.again()


def trail_of(autopilot: Autopilot) -> Trail | None:
    """The way that a vehicle came; None if its firmware keeps none."""
    return next((watch for watch in autopilot.watches if isinstance(watch, Trail)), None)


def land_by_mission(autopilot: Autopilot, reason: str) -> bool:
    """Fly the mission's landing sequence; False if it has none."""
    start = autopilot.mission.landing_start()
    if start is None or not autopilot.has_position:
        return False
    autopilot.mission.go_to_item(start)
    return autopilot.enter(autopilot.profile.mission, reason)


class SmartReturn(Behaviour):
    """SMART_RTL: back along the trail, then land or stop."""

    def fly(self) -> Iterator[None]:
        """Until it is home, and then for ever."""
        autopilot = self.autopilot
        trail = trail_of(autopilot)
        points = trail.points if trail is not None else []
        while len(points) > 1:
            yield from fly_to(autopilot, points[-1])
            points.pop()
        if autopilot.vehicle.type.flies:
            self.landing = True
            yield from Land(autopilot, points[0] if points else None).fly()
        elif points:
            yield from fly_to(autopilot, points[0])
        while True:
            yield


class LandingSequence(Behaviour):
    """AUTO_RTL: on with the mission at its landing sequence; without one, home."""

    def fly(self) -> Iterator[None]:
        """As the mission does."""
        mission = self.autopilot.mission
        start = mission.landing_start()
        if start is None:
            yield from mission.leave(self.autopilot.profile.return_to_launch, reason="no landing sequence")
            return
        mission.go_to_item(start)
        yield from mission.fly()


class PlaneReturn(Behaviour):
    """RTL of a plane: home and round it, or into the mission's landing sequence if RTL_AUTOLAND says so."""

    def fly(self) -> Iterator[None]:
        """For ever."""
        autopilot = self.autopilot
        wanted = int(autopilot.vehicle.parameters.get("RTL_AUTOLAND", 0))
        sequence = autopilot.mission.landing_start() if wanted in (_AT_HOME, _AT_ONCE) else None
        for _ in ReturnToLaunch(autopilot, forward=True).fly():
            if sequence is not None and (wanted == _AT_ONCE or self._is_home()):
                yield from self._land_by_mission(sequence)
            if self._hovers_at_home() and self._is_home():
                yield from autopilot.mission.leave(_QRTL, reason="home is reached")
            yield

    def _land_by_mission(self, sequence: int) -> Iterator[None]:
        autopilot = self.autopilot
        autopilot.mission.go_to_item(sequence)
        yield from autopilot.mission.leave(autopilot.profile.mission, reason="landing sequence")

    def _hovers_at_home(self) -> bool:
        return int(self.autopilot.vehicle.parameters.get("Q_RTL_MODE", 0)) == _HOVER_AT_HOME

    def _is_home(self) -> bool:
        autopilot = self.autopilot
        near = abs(autopilot.flight_parameters.loiter_radius) * 1.5
        return autopilot.maneuvers.distance(autopilot.rally.destination()) <= near


class QuadplaneReturn(ReturnToLaunch):
    """QRTL: home, on the wing while it is far, and down on the lifting motors."""

    def __init__(self, autopilot: Autopilot) -> None:
        near = abs(autopilot.flight_parameters.loiter_radius) * 1.5
        far = autopilot.maneuvers.distance(autopilot.home_position) > near
        super().__init__(autopilot, forward=far and autopilot.body.flies_forward)


class WingTakeoff(Behaviour):
    """TAKEOFF: up to TKOFF_ALT, and round there."""

    def fly(self) -> Iterator[None]:
        """For ever."""
        autopilot = self.autopilot
        if not autopilot.landed:
            autopilot.maneuvers.hold()
        else:
            altitude = self._altitude()
            part = Takeoff(autopilot, altitude, forward=True)
            self._send_statustext(altitude)
            for _ in part.fly():
                self.taking_off = part.taking_off
                yield
            self.taking_off = False
        while True:
            yield

    def _send_statustext(self, altitude: float) -> None:
        vehicle, here = self.autopilot.vehicle, self.autopilot.body.estimate
        speed = hypot(here.velocity_north, here.velocity_east)
        distance = float(vehicle.parameters.get("TKOFF_DIST", 200.0))
        heading = degrees(here.yaw) % 360
        vehicle.send_statustext(f"Triggered AUTO. GPS speed = {speed:.1f}")
        vehicle.send_statustext(f"Takeoff to {altitude:.0f}m for {distance:.1f}m heading {heading:.1f} deg")

    def _altitude(self) -> float:
        return max(float(self.autopilot.vehicle.parameters.get("TKOFF_ALT", 50.0)), 5.0)
