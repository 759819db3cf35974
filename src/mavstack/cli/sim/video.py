"""`mav sim --video`: cameras that really stream, each on a port."""

from __future__ import annotations

from contextlib import AsyncExitStack, asynccontextmanager
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError
from mavstack.sim.vehicle import SimulatedVehicle

if TYPE_CHECKING:
    from argparse import ArgumentParser
    from collections.abc import AsyncIterator, Iterable

#: The default port of the first camera's video.
DEFAULT_PORT: Final = 8554
_MAX_PORT: Final = 65535


def add_video_option(parser: ArgumentParser) -> None:
    """Declare `--video`."""
    parser.add_argument(
        "--video", type=int, nargs="?", const=DEFAULT_PORT, metavar="PORT",
        help="give each vehicle a camera with an RTSP stream of H.264, on ports that count up from this one "
        f"(default: {DEFAULT_PORT}): a horizon by the attitude, and the time",
    )  # fmt: skip


@asynccontextmanager
async def filming(vehicles: Iterable[object], port: int | None) -> AsyncIterator[list[str]]:
    """Let the cameras of vehicles stream until the block ends.

    Args:
        vehicles: The vehicles; flight controllers without MAVLink have no camera.
        port: The port of the first one; None: no camera streams.

    Yields:
        The addresses of the streams.

    Raises:
        UsageError: The port is not one.
        LinkError: A port is in use.
    """
    if port is None:
        yield []
        return
    filmed = [each for each in vehicles if isinstance(each, SimulatedVehicle) and each.camera is not None]
    if not 1 <= port <= _MAX_PORT + 1 - len(filmed):
        raise UsageError(f"--video must be a port from 1 to {_MAX_PORT}, got {port}")
    from mavstack.sim.video_camera import VideoCamera, attitude_picture

    urls = []
    async with AsyncExitStack() as stack:
        for number, vehicle in enumerate(filmed, port):
            body, camera = vehicle.body, vehicle.camera
            draw = attitude_picture(lambda body=body: (body.estimate.roll, body.estimate.pitch))  # type: ignore[misc]
            stream = await stack.enter_async_context(VideoCamera(draw, port=number))
            if camera is not None:
                camera.device.stream_uri = stream.url
            urls.append(stream.url)
        yield urls
