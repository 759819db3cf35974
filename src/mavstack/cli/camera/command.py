"""`mav camera`: images, video, mode, lens, storage and settings of a vehicle's camera."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from mavstack.cli.camera.selection import add_camera_option, known_cameras, selected_camera
from mavstack.cli.camera.settings import settings
from mavstack.cli.camera.show import show_image, show_information
from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_vehicle_action, on_vehicle, run_on_vehicle
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.options import finite_number, seconds
from mavstack.cli.common.output import echo, echo_json, echo_question
from mavstack.cli.common.selection import of_vehicle
from mavstack.dialects import common

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable, Callable

    from mavstack.node.camera import Camera
    from mavstack.vehicle import Vehicle

EXAMPLES = """\
examples:
  mav camera info
  mav camera info --camera 100 --json
  mav camera list
  mav camera photo
  mav camera photo --count 10 --interval 2
  mav camera stop
  mav camera video start
  mav camera video stop
  mav camera stream start 1
  mav camera mode video
  mav camera zoom 50
  mav camera focus auto
  mav camera settings
  mav camera settings CAM_WBMODE
  mav camera settings CAM_WBMODE Sunset
  mav camera track 0.5 0.5 --radius 0.1
  mav camera track 0.2 0.2 0.6 0.7
  mav camera track off
  mav camera format --yes
  mav camera reset
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "camera", EXAMPLES)
    _add(actions, "info", "show identity, abilities, mode, storages and streams", info)
    add_vehicle_action(actions, "list", "list the cameras of the vehicle", list_cameras)
    action = _add(actions, "photo", "take one image, or a series, and show where", photo, changes=True)
    action.add_argument("--count", type=_count, default=1, metavar="N", help="number of images (default: 1)")
    action.add_argument(
        "--interval", type=seconds, default=1.0, metavar="SECONDS", help="between two images (default: 1)"
    )
    _add(actions, "stop", "end a series of images", stop, changes=True)
    action = _add(actions, "video", "begin or end a recording", video, changes=True)
    action.add_argument("state", choices=("start", "stop"), help="start or stop")
    action = _add(actions, "stream", "begin or end to send a video stream", stream, changes=True)
    action.add_argument("state", choices=("start", "stop"), help="start or stop")
    action.add_argument("stream", nargs="?", type=_count, default=1, metavar="NUMBER", help="default: 1")
    action = _add(actions, "mode", "set the mode", mode, changes=True)
    action.add_argument("mode", choices=("photo", "video", "survey"), help="photo, video or survey")
    action = _add(actions, "zoom", "zoom", zoom, changes=True)
    action.add_argument("percent", type=finite_number, metavar="PERCENT", help="of the range, 0 to 100")
    action = _add(actions, "focus", "focus", focus, changes=True)
    action.add_argument("value", metavar="PERCENT|auto", help="of the range, 0 to 100, or auto")
    action = _add(actions, "settings", "show or set the settings of the camera", settings, changes=True)
    action.add_argument("name", nargs="?", metavar="NAME", help="setting (default: all)")
    action.add_argument("value", nargs="?", metavar="VALUE", help="option or number to set")
    action.add_argument("--definition", metavar="FILE", help="camera definition file (default: the camera's)")
    action = _add(actions, "track", "track a point or a rectangle of the image", track, changes=True)
    action.add_argument(
        "place", nargs="+", metavar="SHARE", help="X Y, or LEFT TOP RIGHT BOTTOM, from 0 to 1; or off"
    )
    action.add_argument(
        "--radius", type=finite_number, default=0.0, metavar="SHARE", help="radius of a point (default: 0)"
    )
    action = _add(actions, "format", "erase the storage of the camera", format_storage, changes=True)
    action.add_argument("--storage", type=_count, default=1, metavar="N", help="number (default: 1)")
    action.add_argument("-y", "--yes", action="store_true", help="do not ask for confirmation")
    _add(actions, "reset", "reset the settings of the camera", reset, changes=True)


@on_vehicle
async def info(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav camera info`."""
    camera = await selected_camera(vehicle, arguments)
    await show_information(camera, as_json=arguments.json)
    return 0


@on_vehicle
async def list_cameras(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav camera list`."""
    cameras = await known_cameras(vehicle)
    rows = [
        {"id": each.device_id or each.address.component, "attached": bool(each.device_id)} for each in cameras
    ]
    if arguments.json:
        echo_json(rows)
    elif rows:
        attached = " (attached to the autopilot)"
        echo(*(f"camera {row['id']}{attached if row['attached'] else ''}" for row in rows))
    else:
        echo("there are no cameras", error=True)
    return 0


@on_vehicle
async def photo(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav camera photo`."""
    camera = await selected_camera(vehicle, arguments)
    if arguments.count == 1:
        show_image(await camera.take_photo(), as_json=arguments.json)
        return 0
    return await _series(camera, arguments)


def stop(arguments: Namespace) -> int:
    """Run `mav camera stop`."""
    return _act(arguments, lambda camera: camera.stop_photos(), "no series of images")


def video(arguments: Namespace) -> int:
    """Run `mav camera video`."""
    if arguments.state == "start":
        return _act(arguments, lambda camera: camera.start_video(), "recording")
    return _act(arguments, lambda camera: camera.stop_video(), "recording ended")


def stream(arguments: Namespace) -> int:
    """Run `mav camera stream`."""
    number = arguments.stream
    if arguments.state == "start":
        return _act(arguments, lambda camera: camera.start_streaming(number), f"stream {number} started")
    return _act(arguments, lambda camera: camera.stop_streaming(number), f"stream {number} stopped")


def mode(arguments: Namespace) -> int:
    """Run `mav camera mode`."""
    return _act(arguments, lambda camera: camera.set_mode(arguments.mode), f"mode {arguments.mode}")


def zoom(arguments: Namespace) -> int:
    """Run `mav camera zoom`."""
    text = f"zoom {arguments.percent:g} %"
    return _act(arguments, lambda camera: camera.set_zoom(arguments.percent), text)


def focus(arguments: Namespace) -> int:
    """Run `mav camera focus`."""
    if arguments.value == "auto":
        kind = common.SetFocusType.AUTO
        return _act(arguments, lambda camera: camera.set_focus(kind=kind), "automatic focus")
    percent = _numbers([arguments.value])[0]
    return _act(arguments, lambda camera: camera.set_focus(percent), f"focus {percent:g} %")


def track(arguments: Namespace) -> int:
    """Run `mav camera track`."""
    if arguments.place == ["off"]:
        return _act(arguments, lambda camera: camera.stop_tracking(), "tracking ended")
    numbers = _numbers(arguments.place)
    match numbers:
        case [x, y]:
            radius = arguments.radius
            return _act(arguments, lambda camera: camera.track_point(x, y, radius=radius), "tracking a point")
        case [left, top, right, bottom]:
            return _act(
                arguments,
                lambda camera: camera.track_rectangle(left, top, right, bottom),
                "tracking a rectangle",
            )
    raise UsageError("track takes X Y, LEFT TOP RIGHT BOTTOM, or off")


def format_storage(arguments: Namespace) -> int:
    """Run `mav camera format`."""
    if not arguments.yes and not sys.stdin.isatty():
        raise UsageError("add --yes to erase the storage without confirmation")
    number = arguments.storage
    if not arguments.yes:
        echo_question(f"erase storage {number} of the camera? [y/N] ")
        if sys.stdin.readline().strip().lower() not in ("y", "yes"):
            echo("nothing was erased", error=True)
            return 1
    return _act(arguments, lambda camera: camera.format_storage(number), f"storage {number} erased")


def reset(arguments: Namespace) -> int:
    """Run `mav camera reset`."""
    return _act(arguments, lambda camera: camera.reset_settings(), "settings reset")


async def _series(camera: Camera, arguments: Namespace) -> int:
    """Take a series of images, and show each of them; Ctrl-C ends it on the camera too."""
    taken = 0
    async with camera.images() as images:
        await camera.start_photos(arguments.interval, count=arguments.count)
        try:
            async for event in images:
                if event.image.device_id != camera.device_id:
                    continue
                taken += 1
                show_image(event.image, as_json=arguments.json)
                if taken == arguments.count:
                    return 0
        finally:
            if taken < arguments.count:
                await camera.stop_photos()
    raise CommandError("the connection was closed")


def _act(arguments: Namespace, do: Callable[[Camera], Awaitable[object]], text: str) -> int:
    """Run a call of the camera, and print its outcome."""

    async def work(vehicle: Vehicle) -> int:
        camera = await selected_camera(vehicle, arguments)
        await do(camera)
        if arguments.json:
            echo_json({"system": vehicle.system, "camera": str(camera.address), "ok": True, "text": text})
        else:
            echo(of_vehicle(vehicle, text))
        return 0

    return run_on_vehicle(arguments, work)


def _add(
    actions: Actions, name: str, summary: str, do: Callable[[Namespace], int], *, changes: bool = False
) -> ArgumentParser:
    action = add_vehicle_action(actions, name, summary, do, changes=changes)
    add_camera_option(action)
    return action


def _numbers(words: list[str]) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError:
        raise UsageError(f"{' '.join(words)!r} is not a number") from None


def _count(text: str) -> int:
    from argparse import ArgumentTypeError

    if not (text.isdecimal() and 1 <= int(text) <= 100_000):
        raise ArgumentTypeError(f"{text!r} is not a number from 1")
    return int(text)
