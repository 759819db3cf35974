"""The actions of `mav vehicle` on outputs and payload: servo, relay, gripper, motor test, ROI."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.confirmation import add_yes_option, is_confirmed
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import finite_number
from mavstack.cli.vehicle.arguments import add_flight, add_timed
from mavstack.cli.vehicle.outcomes import on_vehicles, run_on_vehicles

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable

    from mavstack.cli.common.actions import Actions
    from mavstack.vehicle import Vehicle

_WINGS: Final = {"fixed-wing": True, "multicopter": False}


def add_actions(actions: Actions) -> None:
    """Declare the actions."""
    _add_outputs(actions)
    _add_payload(actions)
    action = add_flight(actions, "transition", "change a VTOL between hovering and wing", transition)
    action.add_argument("to", choices=_WINGS, help="the form of flight")
    action = add_timed(actions, "ekf-source", "select a set of estimator sources (ArduPilot)", ekf_source)
    action.add_argument("number", type=int, choices=(1, 2, 3), metavar="1|2|3", help="number of the set")
    add_yes_option(add_timed(actions, "terminate", "stop the motors permanently, also in flight", terminate))


def _add_outputs(actions: Actions) -> None:
    action = add_timed(actions, "servo", "set the pulse of a servo output (ArduPilot)", servo)
    _add_number(action, "output, from 1")
    action.add_argument("pulse", type=int, metavar="MICROSECONDS", help="0 to 2500; 0 stops the pulses")
    action = add_timed(actions, "relay", "switch a relay (ArduPilot)", relay)
    _add_number(action, "relay, from 0")
    action.add_argument("state", choices=("on", "off"), help="on or off")
    action = add_timed(actions, "actuator", "set an actuator output (PX4)", actuator)
    _add_number(action, "actuator, from 1")
    action.add_argument("value", type=finite_number, metavar="VALUE", help="-1 to 1")
    action = add_timed(
        actions, "motor-test", "run one motor for some time; take the propellers off", motor_test
    )
    _add_number(action, "motor, from 1")
    action.add_argument(
        "--throttle", type=finite_number, default=5.0, metavar="PERCENT", help="0 to 100 (default: 5)"
    )
    action.add_argument(
        "--duration", type=finite_number, default=2.0, metavar="SECONDS", help="up to 600 (default: 2)"
    )
    add_yes_option(action)


def _add_payload(actions: Actions) -> None:
    action = add_timed(actions, "gripper", "close or open a gripper", gripper)
    action.add_argument("what", choices=("grip", "release"), help="close or open")
    action.add_argument(
        "--number", type=int, default=1, metavar="N", help="number of the gripper (default: 1)"
    )
    action = add_flight(actions, "winch", "run a winch", winch)
    action.add_argument(
        "what", choices=("unwind", "run", "relax"), help="by length, at a rate, or run freely"
    )
    action.add_argument(
        "value",
        nargs="?",
        type=finite_number,
        metavar="M|M/S",
        help="metres or metres per second; negative: in",
    )
    action.add_argument("--rate", type=finite_number, default=0.0, metavar="M/S", help="rate of `unwind`")
    action.add_argument("--number", type=int, default=1, metavar="N", help="number of the winch (default: 1)")
    action = add_timed(actions, "roi", "set the place that the gimbal or the nose points at", roi)
    action.add_argument(
        "place", nargs="+", metavar="PLACE", help="LAT LON [M above home], `next` (waypoint), or `none`"
    )


@on_vehicles
async def servo(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle servo`."""
    timeout = arguments.action_timeout
    await vehicle.actuators.set_servo(arguments.number, arguments.pulse, timeout=timeout)
    return f"servo {arguments.number} at {arguments.pulse} µs"


@on_vehicles
async def relay(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle relay`."""
    on = arguments.state == "on"
    await vehicle.actuators.set_relay(arguments.number, on, timeout=arguments.action_timeout)
    return f"relay {arguments.number} {arguments.state}"


@on_vehicles
async def actuator(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle actuator`."""
    timeout = arguments.action_timeout
    await vehicle.actuators.set_actuator(arguments.number, arguments.value, timeout=timeout)
    return f"actuator {arguments.number} at {arguments.value:g}"


def motor_test(arguments: Namespace) -> int:
    """Run `mav vehicle motor-test`."""
    question = f"run motor {arguments.number} at {arguments.throttle:g} %; are the propellers off"
    if not is_confirmed(arguments, question, "run a motor"):
        return 1

    async def work(vehicle: Vehicle) -> str:
        await vehicle.actuators.test_motor(
            arguments.number,
            throttle=arguments.throttle,
            duration=arguments.duration,
            timeout=arguments.action_timeout,
        )
        return f"motor {arguments.number} ran for {arguments.duration:g} s"

    return run_on_vehicles(arguments, work)


def gripper(arguments: Namespace) -> int:
    """Run `mav vehicle gripper`."""
    closes = arguments.what == "grip"

    async def work(vehicle: Vehicle) -> str:
        move = vehicle.actuators.grip if closes else vehicle.actuators.release
        await move(arguments.number, timeout=arguments.action_timeout)
        return "gripper closed" if closes else "gripper open"

    return run_on_vehicles(arguments, work)


def winch(arguments: Namespace) -> int:
    """Run `mav vehicle winch`."""
    what, value = arguments.what, arguments.value
    if (value is None) != (what == "relax"):
        raise UsageError("usage: winch unwind METRES, winch run METRES_PER_SECOND, or winch relax")

    def command(vehicle: Vehicle) -> Awaitable[None]:
        outputs, number, timeout = vehicle.actuators, arguments.number, arguments.action_timeout
        wait = arguments.wait
        if what == "unwind":
            return outputs.unwind(value, rate=arguments.rate, winch=number, wait=wait, timeout=timeout)
        if what == "run":
            return outputs.run_winch(value, winch=number, wait=wait, timeout=timeout)
        return outputs.relax_winch(number, timeout=timeout)

    async def work(vehicle: Vehicle) -> str:
        await command(vehicle)
        unwound = f"{'unwound' if arguments.wait else 'unwinding'} {value} m"
        return {"unwind": unwound, "run": f"running at {value} m/s"}.get(what, "winch relaxed")

    return run_on_vehicles(arguments, work)


def roi(arguments: Namespace) -> int:
    """Run `mav vehicle roi`."""
    words, timeout = arguments.place, arguments.action_timeout
    place = None if words in (["next"], ["none"]) else _place(words)

    async def work(vehicle: Vehicle) -> str:
        if place is not None:
            await vehicle.roi.set_location(*place, timeout=timeout)
            return f"pointing at {place[0]:.7f} {place[1]:.7f}"
        if words == ["next"]:
            await vehicle.roi.set_next_waypoint(timeout=timeout)
            return "pointing at the next waypoint"
        await vehicle.roi.clear(timeout=timeout)
        return "pointing ahead"

    return run_on_vehicles(arguments, work)


def transition(arguments: Namespace) -> int:
    """Run `mav vehicle transition`."""
    wing = _WINGS[arguments.to]

    async def work(vehicle: Vehicle) -> str:
        change = vehicle.transition_to_fixed_wing if wing else vehicle.transition_to_multicopter
        await change(wait=arguments.wait, timeout=arguments.action_timeout)
        text = "flying on its wing" if wing else "hovering"
        return text if arguments.wait else f"changing to {arguments.to} flight"

    return run_on_vehicles(arguments, work)


@on_vehicles
async def ekf_source(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle ekf-source`."""
    await vehicle.set_ekf_source(arguments.number, timeout=arguments.action_timeout)
    return f"estimator source set {arguments.number}"


def terminate(arguments: Namespace) -> int:
    """Run `mav vehicle terminate`."""
    if not is_confirmed(arguments, "stop the motors permanently; in flight it crashes", "terminate a flight"):
        return 1

    async def work(vehicle: Vehicle) -> str:
        await vehicle.terminate(timeout=arguments.action_timeout)
        return "flight terminated"

    return run_on_vehicles(arguments, work)


def _place(words: list[str]) -> tuple[float, ...]:
    try:
        place = tuple(map(float, words))
    except ValueError:
        place = ()
    if len(place) not in (2, 3):
        raise UsageError("roi is LAT LON [ALT] in degrees and metres above home, `next`, or `none`")
    return place


def _add_number(parser: ArgumentParser, what: str) -> None:
    parser.add_argument("number", type=int, metavar="N", help=f"number of the {what}")
