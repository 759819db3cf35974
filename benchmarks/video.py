"""The delay of video through the ground station, from the picture of a camera to that of a viewer.

    python -m benchmarks.video [--pictures 150]

A simulated camera writes the time into each picture. It streams over RTSP to the WebRTC side of the station,
whose viewer is aiortc in the place of a browser; all of them run in this process.
"""

from __future__ import annotations

import argparse
import asyncio
import statistics
from time import time
from typing import TYPE_CHECKING, Any, Final

import aiortc

from mavstack.server.video.addresses import read_address
from mavstack.server.video.gateway import VideoGateway
from mavstack.sim.payloads.picture import read_time
from mavstack.sim.video_camera import RATE, VideoCamera, attitude_picture

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator

#: Pictures after which the stream flows.
WARM_UP: Final = 50


async def _delays(camera: VideoCamera, gateway: VideoGateway) -> AsyncGenerator[float, None]:
    """Watch a camera; yield the age of each picture in seconds when the viewer has decoded it."""
    peer = aiortc.RTCPeerConnection()
    tracks: asyncio.Queue[aiortc.MediaStreamTrack] = asyncio.Queue()
    peer.addTransceiver("video", direction="recvonly")
    peer.on("track", tracks.put_nowait)
    try:
        await peer.setLocalDescription(await peer.createOffer())
        answer = await gateway.watch(read_address(camera.url), peer.localDescription.sdp)
        await peer.setRemoteDescription(aiortc.RTCSessionDescription(answer.sdp, "answer"))
        track = await tracks.get()
        while True:
            picture: Any = await track.recv()
            yield time() - read_time(picture.to_ndarray(format="rgb24"))
    finally:
        await peer.close()


async def measure(pictures: int) -> list[float]:
    """Return the delays of pictures in seconds."""
    gateway, found = VideoGateway(), list[float]()
    async with VideoCamera(attitude_picture(lambda: (0.1, 0.0))) as camera:
        delays = _delays(camera, gateway)
        async for delay in delays:
            found.append(delay)
            if len(found) == WARM_UP + pictures:
                break
        await delays.aclose()
        await gateway.close()
    return found[WARM_UP:]


def main() -> None:
    """Print the delays."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.video", description=__doc__)
    parser.add_argument("--pictures", type=int, default=150, metavar="COUNT")
    delays = asyncio.run(measure(parser.parse_args().pictures))
    high = statistics.quantiles(delays, n=20)[-1]
    print(
        f"{len(delays)} pictures at {RATE}/s: delay {statistics.median(delays) * 1e3:.0f} ms in the median, "
        f"{high * 1e3:.0f} ms in the 95th percentile"
    )


if __name__ == "__main__":
    main()
