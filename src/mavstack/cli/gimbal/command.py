"""`mav gimbal`: point a vehicle's gimbal, and show where it points.

A gimbal manager accepts setpoints of the component in control only, so that the actions that move the gimbal
take control first. They do not take it from another component without `--take`, and keep it: `release` gives
it up.
"""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from typing import TYPE_CHECKING

from mavstack.cli.camera.selection import payload_id
from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_vehicle_action, on_vehicle, run_on_vehicle
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.options import finite_number, seconds
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.common.selection import of_vehicle
from mavstack.errors import CommandDenied, RemoteDenied

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable, Callable

    from mavstack.node.gimbal import Gimbal
    from mavstack.services.gimbal import GimbalAttitude, GimbalInformation, GimbalStatus
    from mavstack.vehicle import Vehicle

EXAMPLES = """\
examples:
  mav gimbal info
  mav gimbal info --json
  mav gimbal point -45
  mav gimbal point -45 30
  mav gimbal point -20 90 --lock
  mav gimbal point -45 30 --take --no-wait
  mav gimbal turn 0 15
  mav gimbal turn 0 0
  mav gimbal center
  mav gimbal retract
  mav gimbal roi 47.3985 8.5460 0
  mav gimbal roi off
  mav gimbal follow 2
  mav gimbal watch --for 10
  mav gimbal take
  mav gimbal release
"""
#: Seconds to wait for the first message with the attitude of the gimbal.
ATTITUDE_TIMEOUT = 2.0
WATCH_INTERVAL = 0.5
POLL_INTERVAL = 0.1


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "gimbal", EXAMPLES)
    _add(actions, "info", "show ranges, control and attitude of the gimbals", info)
    action = _add_move(actions, "point", "point to a pitch and a yaw", point)
    action.add_argument("pitch", type=finite_number, metavar="PITCH", help="degrees, -90 is straight down")
    action.add_argument("yaw", nargs="?", type=finite_number, metavar="YAW", help="degrees to the right")
    action.add_argument("--lock", action="store_true", help="yaw is from north, and stays there")
    action.add_argument("--no-wait", action="store_true", help="do not wait until the gimbal is there")
    action = _add_move(actions, "turn", "turn at constant rates; 0 0 stops", turn)
    action.add_argument("pitch_rate", type=finite_number, metavar="PITCH", help="degrees per second, up")
    action.add_argument("yaw_rate", type=finite_number, metavar="YAW", help="degrees per second, right")
    _add_move(actions, "center", "point to the neutral position", center)
    _add_move(actions, "retract", "go to the safe position", retract)
    action = _add_move(actions, "roi", "keep a location in view", roi)
    action.add_argument(
        "place", nargs="+", metavar="LAT LON [ALT]", help="degrees, metres above home; or off"
    )
    action = _add_move(actions, "follow", "keep another vehicle in view", follow)
    action.add_argument("target", type=payload_id, metavar="SYSTEM", help="system id of the other vehicle")
    action = _add(actions, "watch", "show the attitude until Ctrl-C", watch)
    action.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")
    _add_move(actions, "take", "take control of the gimbal", take)
    _add(actions, "release", "give up control of the gimbal", release, changes=True)


@on_vehicle
async def info(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav gimbal info`."""
    found = [await _selected(vehicle, arguments)] if arguments.gimbal else await _all_gimbals(vehicle)
    reports = []
    for gimbal in found:
        information = gimbal.information or await gimbal.get_information()
        reports.append((gimbal, information, await _status(gimbal), await _attitude(gimbal)))
    if arguments.json:
        echo_json([_json(*report) for report in reports])
    for report in [] if arguments.json else reports:
        echo(*align_columns(_rows(*report)))
    return 0


def point(arguments: Namespace) -> int:
    """Run `mav gimbal point`."""

    async def do(gimbal: Gimbal) -> str:
        attitude = await gimbal.point(
            arguments.pitch, arguments.yaw, yaw_lock=arguments.lock, wait=not arguments.no_wait
        )
        return "accepted" if arguments.no_wait or attitude is None else _angles(attitude)

    return _move(arguments, do)


def turn(arguments: Namespace) -> int:
    """Run `mav gimbal turn`."""

    async def do(gimbal: Gimbal) -> str:
        await gimbal.turn(arguments.pitch_rate, arguments.yaw_rate)
        moving = arguments.pitch_rate or arguments.yaw_rate
        return "turning" if moving else "stopped"

    return _move(arguments, do)


def center(arguments: Namespace) -> int:
    """Run `mav gimbal center`."""

    async def do(gimbal: Gimbal) -> str:
        attitude = await gimbal.center()
        return "neutral" if attitude is None else _angles(attitude)

    return _move(arguments, do)


def retract(arguments: Namespace) -> int:
    """Run `mav gimbal retract`."""

    async def do(gimbal: Gimbal) -> str:
        await gimbal.retract()
        return "retracted"

    return _move(arguments, do)


def roi(arguments: Namespace) -> int:
    """Run `mav gimbal roi`."""
    if arguments.place == ["off"]:

        async def clear(gimbal: Gimbal) -> str:
            await gimbal.clear_roi()
            return "no region of interest"

        return _move(arguments, clear)
    try:
        latitude, longitude, altitude = ([float(word) for word in arguments.place] + [0.0])[:3]
    except ValueError:
        raise UsageError("roi takes LAT LON [ALT], or off") from None

    async def look(gimbal: Gimbal) -> str:
        await gimbal.set_roi(latitude, longitude, altitude)
        return f"looking at {latitude:g}, {longitude:g}, {altitude:g} m above home"

    return _move(arguments, look)


def follow(arguments: Namespace) -> int:
    """Run `mav gimbal follow`."""

    async def do(gimbal: Gimbal) -> str:
        await gimbal.set_roi_system(arguments.target)
        return f"looking at vehicle {arguments.target}"

    return _move(arguments, do)


@on_vehicle
async def watch(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav gimbal watch`."""
    gimbal = await _selected(vehicle, arguments)
    loop = asyncio.get_running_loop()
    end = None if arguments.duration is None else loop.time() + arguments.duration
    while end is None or loop.time() < end:
        attitude = await _attitude(gimbal)
        if attitude is None:
            raise CommandError("the gimbal does not report its attitude")
        if arguments.json:
            echo_json(asdict(attitude))
        else:
            echo(_angles(attitude), flush=True)
        await asyncio.sleep(WATCH_INTERVAL)
    return 0


def take(arguments: Namespace) -> int:
    """Run `mav gimbal take`."""

    async def do(gimbal: Gimbal) -> str:
        return "in control"

    return _move(arguments, do)


@on_vehicle
async def release(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav gimbal release`."""
    gimbal = await _selected(vehicle, arguments)
    await gimbal.release_control()
    _report(vehicle, gimbal, "control released", arguments)
    return 0


def _move(arguments: Namespace, do: Callable[[Gimbal], Awaitable[str]]) -> int:
    """Take control, move the gimbal, and print the outcome."""

    async def work(vehicle: Vehicle) -> int:
        gimbal = await _selected(vehicle, arguments)
        try:
            await gimbal.take_control(force=arguments.take)
        except CommandDenied:
            pass  # a manager that denies the command has no control, and accepts setpoints of every component
        except RemoteDenied as error:
            raise CommandError(f"{error.answer.partition(';')[0]}; add --take to take it over") from None
        _report(vehicle, gimbal, await do(gimbal), arguments)
        return 0

    return run_on_vehicle(arguments, work)


async def _selected(vehicle: Vehicle, arguments: Namespace) -> Gimbal:
    """Return the gimbal that `--gimbal` names, or all gimbals of the first manager as one."""
    found = await _all_gimbals(vehicle)
    if arguments.gimbal is None:
        first = found[0]
        return first if len(found) == 1 else vehicle.connection.component(*first.address).gimbal
    for gimbal in found:
        if gimbal.device_id == arguments.gimbal:
            return gimbal
    ids = ", ".join(str(gimbal.device_id) for gimbal in found)
    raise UsageError(f"vehicle {vehicle.system} has no gimbal {arguments.gimbal}; its gimbals: {ids}")


async def _all_gimbals(vehicle: Vehicle) -> tuple[Gimbal, ...]:
    found = await vehicle.find_gimbals()
    if not found:
        raise CommandError(f"vehicle {vehicle.system} has no gimbal: no component manages one")
    return found


async def _status(gimbal: Gimbal) -> GimbalStatus | None:
    try:
        return await gimbal.get_status()
    except RemoteDenied:
        return None


async def _attitude(gimbal: Gimbal) -> GimbalAttitude | None:
    """Return the attitude; waits a moment for the first report."""
    for _ in range(round(ATTITUDE_TIMEOUT / POLL_INTERVAL)):
        if gimbal.attitude is not None:
            break
        await asyncio.sleep(POLL_INTERVAL)
    return gimbal.attitude


def _report(vehicle: Vehicle, gimbal: Gimbal, text: str, arguments: Namespace) -> None:
    if arguments.json:
        attitude = gimbal.attitude
        shown = None if attitude is None else asdict(attitude)
        echo_json({"system": vehicle.system, "ok": True, "text": text, "attitude": shown})
    else:
        echo(of_vehicle(vehicle, text))


def _angles(attitude: GimbalAttitude) -> str:
    parts = [f"pitch {attitude.pitch:.0f}"]
    parts += [] if attitude.yaw is None else [f"yaw {attitude.yaw:.0f}"]
    parts += [] if attitude.heading is None else [f"heading {attitude.heading % 360:.0f}"]
    return ", ".join(parts) + " degrees" + (", yaw locked" if attitude.yaw_locked else "")


def _rows(
    gimbal: Gimbal,
    information: GimbalInformation,
    status: GimbalStatus | None,
    attitude: GimbalAttitude | None,
) -> list[tuple[str, str]]:
    name = f"{information.vendor} {information.model}".strip()
    rows = [
        ("gimbal", f"{information.device_id}, managed by {gimbal.address}" + (f", {name}" if name else ""))
    ]
    rows += [
        (axis, f"{first:.0f} to {last:.0f} degrees")
        for axis, (first, last) in (("pitch", information.pitch_range), ("yaw", information.yaw_range))
    ]
    if status is not None:
        owners = [str(each) for each in (status.primary, status.secondary) if each is not None]
        rows += [("control", " and ".join(owners) or "no component")]
    return [*rows, ("attitude", "unknown" if attitude is None else _angles(attitude))]


def _json(
    gimbal: Gimbal,
    information: GimbalInformation,
    status: GimbalStatus | None,
    attitude: GimbalAttitude | None,
) -> dict[str, object]:
    return {
        "manager": str(gimbal.address),
        "information": asdict(information),
        "primary": str(status.primary) if status is not None and status.primary else None,
        "secondary": str(status.secondary) if status is not None and status.secondary else None,
        "attitude": None if attitude is None else asdict(attitude),
    }


def _add(
    actions: Actions, name: str, summary: str, do: Callable[[Namespace], int], *, changes: bool = False
) -> ArgumentParser:
    action = add_vehicle_action(actions, name, summary, do, changes=changes)
    action.add_argument(
        "--gimbal", type=payload_id, metavar="ID", help="gimbal device (default: all of the first manager)"
    )
    return action


def _add_move(actions: Actions, name: str, summary: str, do: Callable[[Namespace], int]) -> ArgumentParser:
    action = _add(actions, name, summary, do, changes=True)
    action.add_argument("--take", action="store_true", help="take control from another component")
    return action
