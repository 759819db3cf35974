"""NAV items: waypoints, takeoffs, landings, returns and delays."""

from __future__ import annotations

from math import cos, radians, remainder, sin, tau
from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviours.guided import Guided
from mavstack.sim.autopilot.behaviours.land import Land
from mavstack.sim.autopilot.behaviours.return_home import ReturnToLaunch
from mavstack.sim.autopilot.behaviours.steps import transition
from mavstack.sim.autopilot.behaviours.takeoff import Takeoff
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.autopilot.mission.rules import Step

#: Minimum climb of a takeoff, in metres.
_MIN_CLIMB = 1.0
_MIN_CLIMB_OF_WING = 10.0
#: Altitude error in metres within which an altitude counts as reached without a stop.
_ALTITUDE_NEAR = 5.0
_DAY = 86400.0
_HEADING_REACHED = radians(5)
#: Height above the ground at which a payload is released, in metres.
_PLACE_HEIGHT = 0.5
#: Maximum slope (height over distance) of a wing's direct landing, close to the slope of its glide without
#: power.
_MAX_GLIDE_SLOPE = 0.15
_SURFACE = 0.0


def waypoint(step: Step) -> Iterator[None]:
    """NAV_WAYPOINT: fly to the point and stay for the hold time."""
    rules, point = step.mission.rules, step.place()
    yield from leave_ground(step)
    yield from use_default_flight_mode(step)
    hold = max(step.number(1), 0.0) if rules.hold_counts else 0.0
    radius = step.number(2) if rules.radius_counts and step.number(2) > 0 else None
    yield from step.travel(_passed(step, point), yaw=step.yaw() if rules.yaw_counts else None, radius=radius)
    rules.arrived(step, hold)
    if hold > 0:
        yield from stay(step, point, hold)
    rules.waited(step)


def leave_ground(step: Step) -> Iterator[None]:
    """Take off first if the vehicle can fly and is on the ground."""
    if step.mission.rules.grounded:
        yield from step.behave(Takeoff(step.autopilot))


def use_default_flight_mode(step: Step) -> Iterator[None]:
    """Make a VTOL fly forward where its firmware does."""
    forward = step.mission.rules.waypoints_fly_forward and not step.mission.hovers
    if (
        step.autopilot.vehicle.vehicle_type is VehicleType.VTOL
        and forward
        and not step.autopilot.body.flies_forward
    ):
        yield from transition(step.autopilot, forward=True)


def stay(step: Step, point: Point, seconds: float) -> Iterator[None]:
    """Stay at a point; a wing circles it."""
    if step.maneuvers.circles:
        step.mission.course.clear()
        step.maneuvers.hold(point)
    yield from step.wait(seconds)


def _passed(step: Step, point: Point) -> Point:
    """Return the target of a wing that passes the waypoint at a distance (param 3)."""
    beyond = step.number(3)
    if not step.mission.rules.passes_by or beyond <= 0:
        return point
    course = step.maneuvers.bearing(point)
    return point[0] + cos(course) * beyond, point[1] + sin(course) * beyond, point[2]


def take_off(step: Step) -> Iterator[None]:
    """NAV_TAKEOFF: climb, then go to the item's position where the firmware does; a wing does not."""
    yield from _climb(step, forward=False)
    wing = step.autopilot.vehicle.vehicle_type is VehicleType.PLANE
    if step.mission.rules.takeoff_flies_to_position and step.has_place and not wing:
        yield from step.travel(step.place())


def vtol_take_off(step: Step) -> Iterator[None]:
    """NAV_VTOL_TAKEOFF: climb vertically, then fly forward where the firmware does."""
    yield from _climb(step, forward=not step.mission.rules.waypoints_fly_forward)


def _climb(step: Step, *, forward: bool) -> Iterator[None]:
    autopilot = step.autopilot
    kind, here = autopilot.vehicle.vehicle_type, step.maneuvers.place[2]
    min_climb = _MIN_CLIMB_OF_WING if kind is VehicleType.PLANE else _MIN_CLIMB
    down = step.place()[2]
    if autopilot.landed:
        down = min(down, here - min_climb)
    yaw = step.yaw() if step.mission.rules.yaw_counts else None
    yield from step.behave(Takeoff(autopilot, down=down, yaw=yaw, forward=forward))


def land(step: Step) -> Iterator[None]:
    """NAV_LAND: go to the position, if there is one, and land."""
    autopilot, here = step.autopilot, step.maneuvers.place[2]
    kind, point = autopilot.vehicle.vehicle_type, step.place()
    if kind is VehicleType.PLANE:
        landing = Land(autopilot, point, direct=_is_lined_up(step, point))
        yield from (
            step.behave(landing) if step.mission.rules.wing_stays_landed else _until_down(step, landing)
        )
        return
    if step.has_place and not autopilot.landed:
        yield from step.travel((point[0], point[1], here))
    if kind is VehicleType.SUB:
        yield from step.travel((*step.maneuvers.place[:2], _SURFACE))
    elif kind.flies:
        precise = autopilot.precise_landing(step.whole(2) or 0)
        yield from _until_down(step, precise or Land(autopilot, point if step.has_place else None))


def _is_lined_up(step: Step, point: Point) -> bool:
    """Return whether a wing can descend to a point without a circle."""
    away = step.maneuvers.distance(point)
    return away > 0 and -step.maneuvers.place[2] / away < _MAX_GLIDE_SLOPE


def _until_down(step: Step, behaviour: Behaviour) -> Iterator[None]:
    """Run a behaviour until the vehicle is on the ground."""
    for _ in step.behave(behaviour):
        if step.autopilot.landed and behaviour.landing:
            break
        yield
    step.mission.part = None


def return_to_launch(step: Step) -> Iterator[None]:
    """NAV_RETURN_TO_LAUNCH: return by the mode, or as an item."""
    autopilot = step.autopilot
    if step.mission.rules.returns_in_mode:
        yield from step.mission.rules.go_home(step)
    if autopilot.vehicle.vehicle_type is VehicleType.SUB:
        yield from step.travel(autopilot.home_position)
        return
    yield from _until_down(step, ReturnToLaunch(autopilot))


def delay(step: Step) -> Iterator[None]:
    """NAV_DELAY: stay for param 1 seconds, or until a time of the day (UTC)."""
    seconds = step.number(1)
    if seconds < 0:
        wanted = max(step.number(2), 0) * 3600 + max(step.number(3), 0) * 60 + max(step.number(4), 0)
        seconds = (wanted - step.autopilot.now) % _DAY
    if not step.mission.rules.grounded and step.mission.course.point is None:
        step.maneuvers.hold()
    yield from step.wait(seconds)


def change_altitude(step: Step) -> Iterator[None]:
    """NAV_CONTINUE_AND_CHANGE_ALT: fly straight on to an altitude; param 1: 1 climbs, 2 descends."""
    yield from leave_ground(step)
    down = step.place()[2]
    if step.maneuvers.circles:
        step.mission.course.clear()
        step.maneuvers.fly_on(down=down)
    else:
        north, east, _ = step.maneuvers.place
        step.mission.set_course((north, east, down))
    while not _is_through(step, down):
        step.mission.keep_course()
        yield


def _is_through(step: Step, down: float) -> bool:
    above = down - step.maneuvers.place[2]
    match step.whole(1):
        case 1:
            return above >= 0 or step.maneuvers.is_at_altitude(down)
        case 2:
            return above <= 0 or step.maneuvers.is_at_altitude(down)
    return abs(above) <= _ALTITUDE_NEAR


def fly_guided(step: Step) -> Iterator[None]:
    """NAV_GUIDED_ENABLE: follow setpoints until a limit of DO_GUIDED_LIMITS; param 1 = 0 skips the item."""
    if step.number(1) <= 0:
        return
    limits, begun, start = step.mission.guided_limits, step.now, step.maneuvers.place
    script = step.behave(Guided(step.autopilot))
    while not limits.reached(step.now - begun, step.autopilot.altitude, step.maneuvers.distance(start)):
        next(script, None)
        yield
    step.mission.part = None


def turn_and_drive(step: Step) -> Iterator[None]:
    """NAV_SET_YAW_SPEED: turn to param 1 degrees, relative if param 3 is 1, at param 2 m/s."""
    heading = radians(step.number(1))
    if step.whole(3) == 1:
        heading += step.autopilot.body.estimate.yaw
    speed = step.number(2)
    step.mission.course.clear()
    while abs(remainder(step.autopilot.body.estimate.yaw - heading, tau)) > _HEADING_REACHED:
        step.autopilot.body.fly_velocity(cos(heading) * speed, sin(heading) * speed, 0.0, yaw=heading)
        yield


def wait_for_altitude(step: Step) -> Iterator[None]:
    """NAV_ALTITUDE_WAIT: wait for the altitude of param 1 or the descent rate of param 2."""
    highest, fastest = step.number(1), step.number(2)
    body = step.autopilot.body
    body_frame_height = body.frame.altitude
    while body_frame_height - body.estimate.down < highest:
        if fastest > 0 and body.estimate.velocity_down > fastest:
            return
        yield


def place_payload(step: Step) -> Iterator[None]:
    """NAV_PAYLOAD_PLACE: go there, descend, release, climb."""
    yield from leave_ground(step)
    here = step.maneuvers.place[2]
    north, east, _ = step.place()
    yield from step.travel((north, east, here))
    if not step.maneuvers.circles:
        yield from step.travel((north, east, -_PLACE_HEIGHT))
    step.autopilot.payload.grip(closed=False)
    if not step.maneuvers.circles:
        yield from step.travel((north, east, here))
