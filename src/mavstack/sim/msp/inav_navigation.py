"""Navigation of iNav on a multirotor: altitude and position hold, cruise, missions, return to home, landing.

The boxes choose what is flown, the first of this list: failsafe, NAV RTH, NAV WP, NAV CRUISE, NAV COURSE
HOLD, NAV POSHOLD, NAV ALTHOLD. Each is a script (see `scripts`); MSP_NAV_STATUS reports its mode, state and
error. In position hold the sticks move the vehicle, and with the box GCS NAV a ground station does, by
waypoint 255.
"""

from __future__ import annotations

from math import atan2, cos, hypot, inf, radians, sin
from typing import TYPE_CHECKING, Final

from mavstack.msp.messages.navigation import HOME_WAYPOINT, NavError, NavMode, NavState, WaypointAction, Wp
from mavstack.sim.msp import scripts
from mavstack.sim.msp.receiver import LOW
from mavstack.sim.msp.waypoints import ABOVE_SEA, WITHOUT_POSITION, Mission

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.sim.msp.receiver import Sticks
    from mavstack.sim.msp.system import System


#: Special waypoint numbers: the vehicle's target, and its position. Writing the second one sets the target.
TARGET, GUIDED = 254, 255
#: Boxes that navigate, by descending priority.
NAVIGATION_BOXES: Final = ("NAV RTH", "NAV WP", "NAV CRUISE", "NAV COURSE HOLD", "NAV POSHOLD", "NAV ALTHOLD")
_NEEDS_POSITION: Final = frozenset(NAVIGATION_BOXES) - {"NAV ALTHOLD"}
#: The altitude is held while the throttle differs from its middle by less than this (full range: -1 to 1).
_THROTTLE_DEADBAND: Final = 0.1
_HOVER_SECONDS: Final = 3.0
#: Stick movements of up to this many microseconds from the middle are ignored.
_DEADBAND: Final = 5
_UNLIMITED: Final = -1


class InavNavigation:
    """The navigation of one controller."""

    def __init__(self, controller: System, mission: Mission) -> None:
        self._controller, self._body, self.mission = controller, controller.body, mission
        self.script = scripts.Script()
        self.mode, self.state, self.error = NavMode.NONE, NavState.NONE, NavError.NONE
        #: Number of the waypoint that is flown, from 1; 0 for none.
        self.active_waypoint = 0
        #: The position that a ground station has set as target, in metres north, east and down; None if there
        #: is none.
        self.guided: tuple[float, float, float] | None = None

    # --- selection of the navigation box

    def choose(self) -> str:
        """Return the box that navigates now; an empty text if the sticks fly."""
        controller = self._controller
        if not controller.arming.armed:
            return ""
        if controller.failsafe.is_active:
            can_return = controller.has_fix and controller.home is not None
            return (
                "NAV RTH" if can_return and self._controller.number("failsafe_procedure") == 2 else "FAILSAFE"
            )
        for box in NAVIGATION_BOXES:
            if box in controller.switched_on and self._is_possible(box):
                return box
        return ""

    def _is_possible(self, box: str) -> bool:
        if box in _NEEDS_POSITION and not self._controller.has_fix:
            self.error = NavError.GPS_FIX_LOST
            return False
        if box == "NAV WP" and not self.mission.is_valid:
            return False
        return not (box in ("NAV RTH", "NAV WP") and self._controller.home is None)

    def fly(self) -> str:
        """Fly one step; returns the box that navigates, empty if the sticks fly."""
        chosen = self.choose()
        if not chosen or (self._body.on_ground and self._waits_for_throttle(chosen)):
            self._rest()
            return chosen if not chosen else self._idle(chosen)
        makers: dict[str, Callable[[], Iterator[None]]] = {
            "FAILSAFE": self._land_in_emergency,
            "NAV RTH": self._return_home,
            "NAV WP": self._fly_mission,
            "NAV CRUISE": self._hold_course,
            "NAV COURSE HOLD": self._hold_course,
            "NAV POSHOLD": self._hold_position,
            "NAV ALTHOLD": self._hold_altitude,
        }
        self.script.run(chosen, makers[chosen], self._controller.now)
        return chosen

    def _waits_for_throttle(self, chosen: str) -> bool:
        """Return whether the vehicle stays on the ground until the throttle is raised."""
        if chosen in ("NAV RTH", "FAILSAFE"):
            return self.script.name != chosen or self.script.is_done
        return self.script.name != chosen and self._sticks().throttle < 0.5

    def _idle(self, chosen: str) -> str:
        if not self.script.name:
            self._body.idle()
        if self._controller.failsafe.is_active:
            self._controller.arming.disarm("failsafe on the ground")
        return chosen

    def _rest(self) -> None:
        if self.script.name:
            self.script.stop()
            self.guided = None
        self.mode, self.state, self.active_waypoint = NavMode.NONE, NavState.NONE, 0
        if self.error is not NavError.GPS_FIX_LOST or self._controller.has_fix:
            self.error = NavError.NONE

    def _enter(self, mode: NavMode, state: NavState, error: NavError = NavError.NONE) -> None:
        self.mode, self.state, self.error = mode, state, error

    # --- waypoints

    def write(self, waypoint: Wp) -> bool:
        """Write a waypoint of the mission while disarmed, or the guided position (255); False if refused."""
        controller = self._controller
        if waypoint.index == GUIDED:
            guided = controller.arming.armed and {"GCS NAV", "NAV POSHOLD"} <= controller.switched_on
            self.guided = self._place(waypoint) if guided else None
            return guided
        return not controller.arming.armed and self.mission.write(waypoint)

    def special_position(self, number: int) -> tuple[float, float, float] | None:
        """Return latitude, longitude, altitude of home (0), of the vehicle (255), or of its target (254)."""
        frame, here, home = self._body.frame, self._body.estimate, self._controller.home
        if number == HOME_WAYPOINT:
            return None if home is None else frame.to_global(*home, self._ground)
        if number == GUIDED:
            return frame.to_global(here.north, here.east, here.down)
        return frame.to_global(*self.guided) if number == TARGET and self.guided else None

    def first_place(self) -> tuple[float, float, float] | None:
        """Return the first position of the mission in metres north, east and down; None without one."""
        if not self.mission.is_valid:
            return None
        first = next((each for each in self.mission.waypoints if each.action not in WITHOUT_POSITION), None)
        return None if first is None else self._place(first)

    # --- scripts of the navigation modes

    def _hold_altitude(self) -> Iterator[None]:
        self._enter(NavMode.NONE, NavState.NONE)
        limit = radians(self._controller.number("max_angle_inclination_rll") / 10)
        controller = self._controller
        # The stick sets a velocity instead of a lean, so that only the throttle changes the altitude.
        while True:
            sticks = self._sticks()
            speed = 9.81 * limit
            self._fly_velocity(sticks.pitch * speed, sticks.roll * speed, sticks.yaw)
            if not controller.arming.armed:
                return
            yield

    def _hold_position(self) -> Iterator[None]:
        self._enter(NavMode.HOLD, NavState.HOLD_INFINITE)
        speed = self._controller.number("nav_manual_speed") / 100
        held: tuple[float, float, float] | None = None
        while True:
            sticks = self._sticks()
            climb = self._climb_rate(sticks.throttle)
            if sticks.roll or sticks.pitch or sticks.yaw or climb:
                self._fly_velocity(sticks.pitch * speed, sticks.roll * speed, sticks.yaw)
                held = self.guided = None
            elif self.guided is not None and self.guided != held:
                held = self.guided
                climb_rate = self._auto_climb
                self._body.go_to(*held, speed=self._auto_speed, climb=climb_rate, sink=climb_rate)
            elif held is None:
                here = self._body.estimate
                held = here.north, here.east, here.down
                self._body.go_to(*held)
            yield

    def _hold_course(self) -> Iterator[None]:
        self._enter(NavMode.NAV, NavState.NONE)
        speed = self._controller.number("nav_auto_speed") / 100
        while True:
            sticks = self._sticks()
            self._fly_velocity(speed * max(1 + sticks.pitch, 0.0), 0.0, sticks.yaw)
            yield

    def _fly_velocity(self, ahead: float, right: float, turn: float) -> None:
        """Fly at a velocity relative to the heading in m/s, by the yaw stick and the throttle."""
        yaw = self._body.estimate.yaw
        north, east = ahead * cos(yaw) - right * sin(yaw), ahead * sin(yaw) + right * cos(yaw)
        climb = self._climb_rate(self._sticks().throttle)
        yaw_rate = radians(self._controller.number("yaw_rate") * 10 * turn)
        self._body.fly_velocity(north, east, -climb, yaw_rate=yaw_rate)

    def _climb_rate(self, throttle: float) -> float:
        """Return the climb rate in m/s that a throttle demands; the middle demands none."""
        offset = 2 * throttle - 1
        if abs(offset) < _THROTTLE_DEADBAND:
            return 0.0
        return offset * self._controller.number("nav_mc_manual_climb_rate") / 100

    def _return_home(self) -> Iterator[None]:
        """Climb, fly home, hover there, and land."""
        controller, body = self._controller, self._body
        home = controller.home or (0.0, 0.0)
        self._enter(NavMode.RTH, NavState.RTH_START)
        yield
        here = body.estimate
        away = hypot(here.north - home[0], here.east - home[1])
        down = min(here.down, self._ground - self._controller.number("nav_rth_altitude") / 100)
        if away > self._controller.number("nav_min_rth_distance") / 100:
            self._enter(NavMode.RTH, NavState.RTH_CLIMB, NavError.WAIT_FOR_RTH_ALTITUDE)
            yield from scripts.climb_to(body, down, climb=self._auto_climb)
            self._enter(NavMode.RTH, NavState.RTH_ENROUTE)
            yield from self._travel((*home, down), self._auto_speed)
        self._enter(NavMode.RTH, NavState.HOVER_ABOVE_HOME)
        yield from scripts.wait(_HOVER_SECONDS)
        if self._controller.number("nav_rth_allow_landing") == 0:
            yield from scripts.wait(inf)
        yield from self._land(NavMode.RTH, home)

    def _land(self, mode: NavMode, place: tuple[float, float] | None) -> Iterator[None]:
        self._enter(mode, NavState.LAND_IN_PROGRESS, NavError.LANDING)
        speeds = scripts.LandingSpeeds(
            self._controller.number("nav_land_maxalt_vspd") / 100,
            self._controller.number("nav_land_minalt_vspd") / 100,
            self._controller.number("nav_land_slowdown_minalt") / 100,
        )
        yield from scripts.land(self._body, speeds, place)
        self._enter(mode, NavState.LANDED)
        self._body.idle()
        if self._controller.number("nav_disarm_on_landing") or self._controller.failsafe.is_active:
            self._controller.arming.disarm("landing")
        yield from scripts.wait(inf)

    def _land_in_emergency(self) -> Iterator[None]:
        self._enter(NavMode.EMERGENCY, NavState.EMERGENCY_LANDING, NavError.LANDING)
        if self._controller.number("failsafe_procedure") == 1:  # the failsafe procedure DROP
            self._controller.arming.disarm("failsafe")
            return
        rate = self._controller.number("nav_emerg_landing_speed") / 100
        while not self._body.on_ground:
            self._body.fly_velocity(0.0, 0.0, rate)
            yield
        self._controller.arming.disarm("failsafe landing")

    # --- missions

    def _fly_mission(self) -> Iterator[None]:
        jumps: dict[int, int] = {}
        number = 1
        heading: float | None = None
        if self._body.on_ground:
            self._enter(NavMode.NAV, NavState.PROCESS_NEXT)
            yield from scripts.climb_to(
                self._body, self._ground - self._take_off_altitude, climb=self._auto_climb
            )
        while 1 <= number <= len(self.mission.waypoints):
            waypoint = self.mission.read(number)
            self.active_waypoint = number
            self._enter(NavMode.NAV, NavState.PROCESS_NEXT)
            match waypoint.action:
                case WaypointAction.JUMP:
                    self.state = NavState.DO_JUMP
                    number = self._next_after_jump(waypoint, jumps)
                    yield
                    continue
                case WaypointAction.RTH:
                    yield from self._return_home_of_mission(waypoint)
                case WaypointAction.SET_HEADING:
                    heading = None if waypoint.parameter_1 == _UNLIMITED else radians(waypoint.parameter_1)
                case WaypointAction.SET_POI:
                    heading = self._bearing_to(waypoint)
                case _:
                    yield from self._fly_leg(waypoint, heading)
            number += 1
        self._enter(NavMode.NAV, NavState.HOLD_INFINITE, NavError.FINISH)
        self._controller.host.announce("mission", "mission complete")
        yield from scripts.hold(self._body)

    @property
    def _take_off_altitude(self) -> float:
        """Altitude in metres to which a mission takes off: that of its first waypoint, at least 3 m."""
        first = self.first_place()
        return 5.0 if first is None else max(self._ground - first[2], 3.0)

    @staticmethod
    def _next_after_jump(waypoint: Wp, jumps: dict[int, int]) -> int:
        done = jumps.get(waypoint.index, 0)
        if waypoint.parameter_2 != _UNLIMITED and done >= waypoint.parameter_2:
            jumps[waypoint.index] = 0
            return waypoint.index + 1
        jumps[waypoint.index] = done + 1
        return waypoint.parameter_1

    def _return_home_of_mission(self, waypoint: Wp) -> Iterator[None]:
        """Return home as an item of a mission; it lands only if `parameter_1` is not 0."""
        home = self._controller.home or (0.0, 0.0)
        self._enter(NavMode.RTH, NavState.RTH_ENROUTE)
        down = min(self._body.estimate.down, self._ground - self._controller.number("nav_rth_altitude") / 100)
        yield from scripts.climb_to(self._body, down, climb=self._auto_climb)
        yield from self._travel((*home, down), self._auto_speed)
        if waypoint.parameter_1:
            yield from self._land(NavMode.NAV, home)

    def _fly_leg(self, waypoint: Wp, heading: float | None) -> Iterator[None]:
        """Fly to a waypoint, and do its action there."""
        self.state = NavState.WP_ENROUTE
        timed = waypoint.action == WaypointAction.POSHOLD_TIME
        speed = (waypoint.parameter_2 if timed else waypoint.parameter_1) / 100 or self._auto_speed
        yield from self._travel(self._place(waypoint), speed, heading)
        self._controller.host.announce("mission", f"waypoint {waypoint.index} reached")
        if timed:
            self._enter(NavMode.NAV, NavState.HOLD_TIMED, NavError.TIME_WAIT)
            yield from scripts.wait(waypoint.parameter_1)
        elif waypoint.action == WaypointAction.LAND:
            yield from self._land(NavMode.NAV, self._place(waypoint)[:2])

    def _travel(
        self, place: tuple[float, float, float], speed: float, yaw: float | None = None
    ) -> Iterator[None]:
        yield from scripts.fly_to(
            self._body,
            place,
            speed=min(speed, self._controller.number("nav_max_auto_speed") / 100),
            climb=self._auto_climb,
            radius=max(self._controller.number("nav_wp_radius") / 100, 1.0),
            yaw=yaw,
        )

    def _bearing_to(self, waypoint: Wp) -> float:
        north, east, _ = self._place(waypoint)
        here = self._body.estimate
        return atan2(east - here.east, north - here.north)

    def _place(self, waypoint: Wp) -> tuple[float, float, float]:
        """Return the position of a waypoint in metres north, east and down."""
        frame = self._body.frame
        if waypoint.latitude or waypoint.longitude:
            north, east, _ = frame.to_local(waypoint.latitude, waypoint.longitude, 0.0)
        else:  # a waypoint without coordinates is at the present position
            north, east = self._body.estimate[:2]
        if waypoint.parameter_3 & ABOVE_SEA:
            return north, east, frame.altitude - waypoint.altitude
        return north, east, self._ground - waypoint.altitude

    @property
    def _ground(self) -> float:
        """The `down` of the place where the controller was armed."""
        return self._body.estimate.down + self._controller.altitude

    @property
    def _auto_speed(self) -> float:
        return self._controller.number("nav_auto_speed") / 100

    @property
    def _auto_climb(self) -> float:
        return self._controller.number("nav_mc_auto_climb_rate") / 100

    def _sticks(self) -> Sticks:
        return self._controller.receiver.sticks(LOW, _DEADBAND, _DEADBAND)
