"""The items that fly somewhere: waypoints, take-offs, landings, returning, waiting."""

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
    from mavstack.sim.autopilot.mission.interfaces import Step

#: A take-off goes at least so high.
_LEAST_CLIMB = 1.0
_LEAST_CLIMB_OF_WING = 10.0
#: So near counts as an altitude that is climbed through.
_ALTITUDE_NEAR = 5.0
_DAY = 86400.0
_HEADING_REACHED = radians(5)
#: A payload is put down from so high.
_PLACE_HEIGHT = 0.5
#: Height over distance down which a wing glides to its touch-down: without power it sinks about so.
_STEEPEST = 0.15
_SURFACE = 0.0


def waypoint(step: Step) -> Iterator[None]:
    """Fly to the point, and stay for its hold time."""
    rules, point = step.mission.rules, step.place()
    yield from leave_ground(step)
    yield from fly_as_usual(step)
    hold = max(step.number(1), 0.0) if rules.hold_counts else 0.0
    radius = step.number(2) if rules.radius_counts and step.number(2) > 0 else None
    yield from step.travel(_passed(step, point), yaw=step.yaw() if rules.yaw_counts else None, radius=radius)
    rules.arrived(step, hold)
    if hold > 0:
        yield from stay(step, point, hold)
    rules.waited(step)


def leave_ground(step: Step) -> Iterator[None]:
    """What flies and stands on the ground takes off first."""
    if step.mission.rules.grounded:
        yield from step.behave(Takeoff(step.autopilot))


def fly_as_usual(step: Step) -> Iterator[None]:
    """A VTOL flies forward where its firmware has it do so."""
    forward = step.mission.rules.waypoints_fly_forward and not step.mission.hovers
    if step.autopilot.vehicle.type is VehicleType.VTOL and forward and not step.autopilot.body.flies_forward:
        yield from transition(step.autopilot, forward=True)


def stay(step: Step, point: Point, seconds: float) -> Iterator[None]:
    """Stay at a point: a wing circles it."""
    if step.maneuvers.circles:
        step.mission.course.forget()
        step.maneuvers.hold(point)
    yield from step.wait(seconds)


def _passed(step: Step, point: Point) -> Point:
    """Where a wing is to fly that passes the waypoint by a distance (param 3)."""
    beyond = step.number(3)
    if not step.mission.rules.passes_by or beyond <= 0:
        return point
    course = step.maneuvers.bearing(point)
    return point[0] + cos(course) * beyond, point[1] + sin(course) * beyond, point[2]


def take_off(step: Step) -> Iterator[None]:
    """Climb to the item's altitude; then, where the firmware does so, go to its place, but for a wing."""
    yield from _climb(step, forward=False)
    wing = step.autopilot.vehicle.type is VehicleType.PLANE
    if step.mission.rules.takeoff_goes_there and step.has_place and not wing:
        yield from step.travel(step.place())


def vtol_take_off(step: Step) -> Iterator[None]:
    """Straight up, and forward from there where the firmware does so."""
    yield from _climb(step, forward=not step.mission.rules.waypoints_fly_forward)


def _climb(step: Step, *, forward: bool) -> Iterator[None]:
    autopilot = step.autopilot
    kind, here = autopilot.vehicle.type, step.maneuvers.place[2]
    least = _LEAST_CLIMB_OF_WING if kind is VehicleType.PLANE else _LEAST_CLIMB
    down = step.place()[2]
    if autopilot.landed:
        down = min(down, here - least)
    yaw = step.yaw() if step.mission.rules.yaw_counts else None
    yield from step.behave(Takeoff(autopilot, down=down, yaw=yaw, forward=forward))


def land(step: Step) -> Iterator[None]:
    """Go to the place, if there is one, and land there."""
    autopilot, here = step.autopilot, step.maneuvers.place[2]
    kind, point = autopilot.vehicle.type, step.place()
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
        yield from _until_down(step, Land(autopilot, point if step.has_place else None))


def _is_lined_up(step: Step, point: Point) -> bool:
    """Whether a wing can come down to a point from where it is without a circle."""
    away = step.maneuvers.distance(point)
    return away > 0 and -step.maneuvers.place[2] / away < _STEEPEST


def _until_down(step: Step, behaviour: Behaviour) -> Iterator[None]:
    """Do it until the vehicle stands on the ground."""
    for _ in step.behave(behaviour):
        if step.autopilot.landed and behaviour.landing:
            break
        yield
    step.mission.part = None


def return_to_launch(step: Step) -> Iterator[None]:
    """Go home: by the mode for it, or as an item."""
    autopilot = step.autopilot
    if step.mission.rules.returns_in_mode:
        yield from step.mission.rules.go_home(step)
    if autopilot.vehicle.type is VehicleType.SUB:
        yield from step.travel(autopilot.home_position)
        return
    yield from _until_down(step, ReturnToLaunch(autopilot))


def delay(step: Step) -> Iterator[None]:
    """Stay for param 1 seconds, or until an hour, minute and second of the day."""
    seconds = step.number(1)
    if seconds < 0:
        wanted = max(step.number(2), 0) * 3600 + max(step.number(3), 0) * 60 + max(step.number(4), 0)
        seconds = (wanted - step.autopilot.now) % _DAY
    if not step.mission.rules.grounded and step.mission.course.point is None:
        step.maneuvers.hold()
    yield from step.wait(seconds)


def change_altitude(step: Step) -> Iterator[None]:
    """Fly straight on, climbing or sinking to an altitude; param 1: 1 at least, 2 at most, else near it."""
    yield from leave_ground(step)
    down = step.place()[2]
    if step.maneuvers.circles:
        step.mission.course.forget()
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


def be_guided(step: Step) -> Iterator[None]:
    """Follow setpoints until a limit of DO_GUIDED_LIMITS is reached; param 1 = 0: go on at once."""
    if step.number(1) <= 0:
        return
    limits, begun, start = step.mission.guided_limits, step.now, step.maneuvers.place
    script = step.behave(Guided(step.autopilot))
    while not limits.reached(step.now - begun, step.autopilot.altitude, step.maneuvers.distance(start)):
        next(script, None)
        yield
    step.mission.part = None


def turn_and_drive(step: Step) -> Iterator[None]:
    """NAV_SET_YAW_SPEED: turn to param 1 degrees, by as many if param 3 is 1, at param 2 m/s."""
    heading = radians(step.number(1))
    if step.whole(3) == 1:
        heading += step.autopilot.body.estimate.yaw
    speed = step.number(2)
    step.mission.course.forget()
    while abs(remainder(step.autopilot.body.estimate.yaw - heading, tau)) > _HEADING_REACHED:
        step.autopilot.body.fly_velocity(cos(heading) * speed, sin(heading) * speed, 0.0, yaw=heading)
        yield


def wait_for_altitude(step: Step) -> Iterator[None]:
    """NAV_ALTITUDE_WAIT: do nothing until it is as high as param 1, or sinks as fast as param 2."""
    highest, fastest = step.number(1), step.number(2)
    body = step.autopilot.body
    body_frame_height = body.frame.altitude
    while body_frame_height - body.estimate.down < highest:
        if fastest > 0 and body.estimate.velocity_down > fastest:
            return
        yield


def place_payload(step: Step) -> Iterator[None]:
    """NAV_PAYLOAD_PLACE: go there, down, let go, up again."""
    yield from leave_ground(step)
    here = step.maneuvers.place[2]
    north, east, _ = step.place()
    yield from step.travel((north, east, here))
    if not step.maneuvers.circles:
        yield from step.travel((north, east, -_PLACE_HEIGHT))
    step.autopilot.payload.grip(closed=False)
    if not step.maneuvers.circles:
        yield from step.travel((north, east, here))
