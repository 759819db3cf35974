"""`mav vehicle`: an action on one or several vehicles; the exit code tells whether it succeeded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.options import finite_number, seconds, system_id
from mavstack.cli.vehicle import calibrate, equipment, events, failure, setup, transponder
from mavstack.cli.vehicle.arguments import (
    add_action,
    add_flight,
    add_override,
    add_place,
    add_timed,
    add_tolerance,
)
from mavstack.cli.vehicle.flight_progress import (
    distance_to_altitude,
    distance_to_home,
    distance_to_place,
    height_above_home,
)
from mavstack.cli.vehicle.outcomes import on_vehicles, run_on_vehicles
from mavstack.cli.vehicle.show import health, info, modes
from mavstack.dialects import common

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.vehicle import Vehicle

EXAMPLES = """\
examples:
  mav vehicle info
  mav vehicle info --json
  mav vehicle health --wait 60
  mav vehicle arm
  mav vehicle arm --all
  mav vehicle takeoff 20
  mav vehicle goto 47.3985 8.5460 30
  mav vehicle orbit 47.3985 8.5460 30 --radius 40 --speed 5
  mav vehicle speed 8
  mav vehicle yaw 90
  mav vehicle hold
  mav vehicle modes
  mav vehicle mode GUIDED
  mav vehicle rtl --no-wait
  mav vehicle goto 47.3985 8.5460 30 --tolerance 2
  mav vehicle land --action-timeout 120
  mav vehicle disarm --force
  mav vehicle home
  mav vehicle home here
  mav vehicle events --severity warning --for 60
  mav vehicle statustext "survey begins"
  mav vehicle servo 9 1900
  mav vehicle relay 0 on
  mav vehicle actuator 1 0.5
  mav vehicle gripper release
  mav vehicle winch unwind 5 --rate 0.5
  mav vehicle motor-test 1 --throttle 8 --duration 2
  mav vehicle roi 47.3985 8.5460
  mav vehicle roi none
  mav vehicle transition fixed-wing
  mav vehicle ekf-source 2
  mav vehicle transponder
  mav vehicle transponder 7000 --flight-id LX1
  mav vehicle transponder --registration N8644B --flight-id LX1
  mav vehicle failure gps off --yes
  mav vehicle failure motor --number 2 --yes
  mav vehicle failure gps ok
  mav vehicle calibrate
  mav vehicle calibrate gyroscope
  mav vehicle calibrate accelerometer --yes --pause 10
  mav vehicle check
  mav vehicle airframe
  mav vehicle airframe 2 1 --dry-run
  mav vehicle ports
  mav vehicle ports SERIAL0 --baud 115200
  mav vehicle terminate
  mav vehicle reboot --systems 1,3-5
  mav vehicle renumber --channel 192.168.1.20:14550
  mav vehicle renumber 7
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "vehicle", EXAMPLES)
    _add_arm(actions)
    _add_force(add_timed(actions, "disarm", "disarm the motors", disarm))
    _add_takeoff(actions)
    add_flight(actions, "land", "land at the current position", land)
    add_tolerance(add_flight(actions, "rtl", "return to home, and land there", rtl))
    add_timed(actions, "hold", "hold the position; a fixed wing circles", hold)
    _add_goto(actions)
    _add_orbit(actions)
    action = add_timed(actions, "mode", "set the flight mode", mode)
    action.add_argument("mode", metavar="NAME", help="name or number of the mode")
    add_action(actions, "modes", "list the flight modes", modes)
    action = add_timed(actions, "speed", "set the ground speed", speed)
    action.add_argument("speed", type=finite_number, metavar="M/S", help="metres per second")
    action = add_flight(actions, "yaw", "turn to a heading", yaw)
    action.add_argument("heading", type=finite_number, metavar="DEGREES", help="clockwise from north")
    action = add_timed(actions, "home", "show or set the home position", home)
    action.add_argument(
        "place", nargs="*", metavar="PLACE", help="here, or LAT LON [ALT] in degrees and metres above sea"
    )
    equipment.add_actions(actions)
    transponder.add_actions(actions)
    failure.add_actions(actions)
    calibrate.add_actions(actions)
    setup.add_actions(actions)
    add_flight(actions, "reboot", "reboot the autopilot, and wait until it is back", reboot)
    action = add_timed(actions, "renumber", "give the vehicle another system id", renumber)
    action.add_argument("id", nargs="?", type=system_id, metavar="ID", help="system id (default: a free one)")
    add_action(actions, "info", "show identity, state and health", info)
    action = add_action(actions, "health", "show whether the vehicle is ready to arm, and why not", health)
    action.add_argument(
        "--wait",
        type=seconds,
        metavar="SECONDS",
        help="wait this long until it is ready, and leave a mode in which its firmware does not arm",
    )
    events.add_actions(actions)
    action = add_action(actions, "statustext", "send a STATUSTEXT to all components on the link", statustext)
    action.add_argument("text", metavar="TEXT", help="the text to send")


def _add_arm(actions: Actions) -> None:
    action = add_timed(actions, "arm", "arm the motors; leave a mode in which the firmware does not arm", arm)
    _add_force(action)
    action.add_argument(
        "--allow-flight",
        action="store_true",
        help="arm also in a mode in which the vehicle starts at once, such as TAKEOFF or AUTO",
    )
    action.add_argument(
        "--keep-mode", action="store_true", help="fail instead of leaving a mode, such as RTL after a landing"
    )


def _add_takeoff(actions: Actions) -> None:
    action = add_flight(actions, "takeoff", "take off to an altitude, and hold there", takeoff)
    action.add_argument(
        "altitude",
        nargs="?",
        type=finite_number,
        default=10.0,
        metavar="ALTITUDE",
        help="metres above home (default: 10)",
    )
    add_tolerance(action)
    add_override(action)


def _add_goto(actions: Actions) -> None:
    action = add_flight(actions, "goto", "fly to a place", goto)
    add_place(action)
    action.add_argument("--yaw", type=finite_number, metavar="DEGREES", help="heading to take there")
    action.add_argument(
        "--radius", type=finite_number, metavar="M", help="radius of the circle that a fixed wing flies there"
    )


def _add_orbit(actions: Actions) -> None:
    action = add_flight(actions, "orbit", "circle around a place", orbit)
    add_place(action)
    action.add_argument(
        "--radius",
        type=finite_number,
        default=20.0,
        metavar="M",
        help="radius in metres, negative for counter-clockwise (default: 20)",
    )
    action.add_argument("--speed", type=finite_number, metavar="M/S", help="speed on the circle")


@on_vehicles
async def arm(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle arm`."""
    await vehicle.arm(
        force=arguments.force,
        allow_flight=arguments.allow_flight,
        keep_mode=arguments.keep_mode,
        timeout=arguments.action_timeout,
    )
    return "armed"


@on_vehicles
async def disarm(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle disarm`."""
    await vehicle.disarm(force=arguments.force, timeout=arguments.action_timeout)
    return "disarmed"


def takeoff(arguments: Namespace) -> int:
    """Run `mav vehicle takeoff`."""
    altitude = arguments.altitude

    async def work(vehicle: Vehicle) -> str:
        options = {"tolerance": arguments.tolerance, "override_limits": arguments.override_limits}
        await vehicle.takeoff(altitude, **options, **_wait_options(arguments))
        height = height_above_home(vehicle)
        reached = f"took off to {altitude:g} m" if height is None else f"{height:.1f} m above home"
        return _outcome(arguments, reached, f"taking off to {altitude:g} m")

    return run_on_vehicles(arguments, work, distance_to_altitude(altitude))


def land(arguments: Namespace) -> int:
    """Run `mav vehicle land`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.land(**_wait_options(arguments))
        return _outcome(arguments, "landed", "landing")

    return run_on_vehicles(arguments, work, height_above_home)


def rtl(arguments: Namespace) -> int:
    """Run `mav vehicle rtl`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.rtl(tolerance=arguments.tolerance, **_wait_options(arguments))
        landed = vehicle.armed is False or vehicle.landed_state == common.MavLandedState.ON_GROUND
        lands = vehicle.vehicle_type.flies and landed
        return _outcome(arguments, "landed at home" if lands else "at home", "returning home")

    return run_on_vehicles(arguments, work, distance_to_home)


@on_vehicles
async def hold(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle hold`."""
    await vehicle.hold(timeout=arguments.action_timeout)
    return "holding"


def goto(arguments: Namespace) -> int:
    """Run `mav vehicle goto`."""
    latitude, longitude, altitude = arguments.latitude, arguments.longitude, arguments.altitude

    async def work(vehicle: Vehicle) -> str:
        options = {"yaw": arguments.yaw, "radius": arguments.radius, **_target_options(arguments)}
        await vehicle.goto(latitude, longitude, altitude, **options)
        return _outcome(arguments, "at the target", "flying to the target")

    return run_on_vehicles(arguments, work, distance_to_place(latitude, longitude))


def orbit(arguments: Namespace) -> int:
    """Run `mav vehicle orbit`."""
    place = arguments.latitude, arguments.longitude, arguments.altitude

    async def work(vehicle: Vehicle) -> str:
        options = {"radius": arguments.radius, "speed": arguments.speed, **_target_options(arguments)}
        await vehicle.orbit(*place, **options)
        return _outcome(arguments, "on the circle", "flying to the circle")

    return run_on_vehicles(arguments, work, distance_to_place(*place[:2]))


@on_vehicles
async def mode(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle mode`."""
    name = arguments.mode
    await vehicle.set_mode(int(name) if name.isdecimal() else name, timeout=arguments.action_timeout)
    return f"mode {vehicle.mode or name}"


@on_vehicles
async def speed(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle speed`."""
    await vehicle.set_speed(arguments.speed, timeout=arguments.action_timeout)
    return f"speed set to {arguments.speed:g} m/s"


@on_vehicles
async def yaw(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle yaw`."""
    await vehicle.set_yaw(arguments.heading, **_wait_options(arguments))
    heading = f"{arguments.heading % 360:g}°"
    return _outcome(arguments, f"heading {heading}", f"turning to {heading}")


def home(arguments: Namespace) -> int:
    """Run `mav vehicle home`."""
    place = _home_place(arguments.place)
    arguments.changes = place is not None

    async def work(vehicle: Vehicle) -> str:
        if place is not None:
            await vehicle.set_home(*place, timeout=arguments.action_timeout)
        else:
            await vehicle.telemetry.request_home()
        where = vehicle.home
        if where is None:
            if place is None:
                raise CommandError(f"vehicle {vehicle.system} has no home position yet")
            return "home is set"
        return f"home is {where.latitude:.7f} {where.longitude:.7f}, {where.altitude:.1f} m above sea"

    return run_on_vehicles(arguments, work)


@on_vehicles
async def reboot(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle reboot`."""
    await vehicle.reboot(**_wait_options(arguments))
    return _outcome(arguments, "rebooted", "rebooting")


@on_vehicles
async def renumber(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle renumber`."""
    done = await vehicle.renumber(arguments.id, timeout=arguments.action_timeout)
    after = ", rebooted" if done.rebooted else ""
    return f"has system id {done.system} now ({done.parameter}{after})"


def statustext(arguments: Namespace) -> int:
    """Run `mav vehicle statustext`."""
    if not arguments.text.strip():
        raise UsageError("the text is empty")

    async def work(vehicle: Vehicle) -> str:
        vehicle.connection.send_statustext(arguments.text)
        return "sent"

    return run_on_vehicles(arguments, work)


def _wait_options(arguments: Namespace) -> dict[str, Any]:
    return {"wait": arguments.wait, "timeout": arguments.action_timeout}


def _target_options(arguments: Namespace) -> dict[str, Any]:
    options = {"tolerance": arguments.tolerance, "override_limits": arguments.override_limits}
    return options | _wait_options(arguments)


def _outcome(arguments: Namespace, completed: str, accepted: str) -> str:
    return completed if arguments.wait else accepted


def _home_place(words: list[str]) -> tuple[float, ...] | None:
    """Parse the home position: None shows it, an empty tuple is the current position."""
    if not words:
        return None
    if words == ["here"]:
        return ()
    try:
        place = tuple(map(float, words))
    except ValueError:
        place = ()
    if len(place) not in (2, 3):
        raise UsageError("home is `here`, or LAT LON [ALT] in degrees and metres above sea")
    return place


def _add_force(parser: ArgumentParser) -> None:
    parser.add_argument("--force", action="store_true", help="override the checks of the vehicle")
