"""Video of a simulated camera through the station, with aiortc in the place of a browser."""

from __future__ import annotations

import asyncio
import socket
import threading
from contextlib import asynccontextmanager
from time import time

import pytest

from mavstack.errors import LinkError
from mavstack.http.bodies import RefusedError
from mavstack.server.video.addresses import read_address
from mavstack.sim.payloads.picture import HEIGHT, WIDTH, draw, read_time

aiortc = pytest.importorskip("aiortc")
av = pytest.importorskip("av")

from mavstack.server.video import gateway as module  # noqa: E402
from mavstack.server.video.gateway import VideoGateway  # noqa: E402
from mavstack.sim.video_camera import VideoCamera, attitude_picture  # noqa: E402
from tests.waiting import wait_until  # noqa: E402


@asynccontextmanager
async def browser(gateway: VideoGateway, url: str):
    """A peer that watches a camera; yields its track and its name at the gateway."""
    peer, tracks = aiortc.RTCPeerConnection(), asyncio.Queue()
    peer.addTransceiver("video", direction="recvonly")
    peer.on("track", tracks.put_nowait)
    try:
        await peer.setLocalDescription(await peer.createOffer())
        answer = await gateway.watch(read_address(url), peer.localDescription.sdp)
        await peer.setRemoteDescription(aiortc.RTCSessionDescription(answer.sdp, "answer"))
        yield await tracks.get(), answer.name
    finally:
        await peer.close()


async def picture_of(track):
    async with asyncio.timeout(20):
        return (await track.recv()).to_ndarray(format="rgb24")


@asynccontextmanager
async def video(attitude=(0.0, 0.0)):
    gateway = VideoGateway()
    try:
        async with VideoCamera(attitude_picture(lambda: attitude)) as camera:
            yield gateway, camera
            await gateway.close()
    finally:
        await gateway.close()


async def test_two_viewers_share_a_camera_and_see_its_time_and_attitude():
    async with video(attitude=(0.5, 0.0)) as (gateway, camera):
        watching = (browser(gateway, camera.url), browser(gateway, camera.url))
        async with watching[0] as (track, name), watching[1] as (other, _):
            pictures = [await picture_of(track) for _ in range(10)]
            assert abs(read_time(pictures[-1]) - time()) < 10
            assert read_time(pictures[-1]) > read_time(pictures[0])
            left, right = pictures[-1][150:170, 20].mean(axis=0), pictures[-1][190:210, 620].mean(axis=0)
            assert left[2] > left[0] + 50  # the sky is up on the left: it rolls to the right
            assert right[0] > right[2] + 20
            assert (await picture_of(other)).shape == pictures[0].shape
            assert (gateway.viewers, gateway.cameras, camera.players) == (2, 1, 1)
            assert gateway.plays(read_address(camera.url))
            assert not gateway.plays(read_address("rtsp://127.0.0.1:9/other"))
            assert await gateway.leave(name)
            assert not await gateway.leave(name)
            assert (gateway.viewers, gateway.cameras) == (1, 1)
    assert (gateway.viewers, gateway.cameras) == (0, 0)


async def test_a_camera_that_does_not_answer_leaves_no_viewer():
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
    gateway = VideoGateway()
    with pytest.raises(LinkError, match="opening the camera failed"):
        async with browser(gateway, f"rtsp://127.0.0.1:{port}/none"):
            pass
    assert (gateway.viewers, gateway.cameras) == (0, 0)


async def test_a_browser_that_does_not_connect_in_time_leaves_no_viewer(monkeypatch):
    monkeypatch.setattr(module, "CONNECT_TIMEOUT", 0.2)
    async with video() as (gateway, camera):
        peer = aiortc.RTCPeerConnection()
        peer.addTransceiver("video", direction="recvonly")
        await peer.setLocalDescription(await peer.createOffer())
        await gateway.watch(read_address(camera.url), peer.localDescription.sdp)
        assert gateway.viewers == 1
        await wait_until(lambda: (gateway.viewers, gateway.cameras) == (0, 0))
        await peer.close()


async def test_a_camera_that_ended_its_stream_is_opened_again():
    async with video() as (gateway, camera), browser(gateway, camera.url) as (track, _):
        await picture_of(track)
        (source,) = gateway._sources.values()
        source._track.stop()
        async with browser(gateway, camera.url) as (other, _):
            await picture_of(other)
            assert gateway.cameras == 1
            assert gateway._sources != {next(iter(gateway._sources)): source}


async def test_viewers_are_bounded(monkeypatch):
    monkeypatch.setattr(module, "MAX_VIEWERS", 0)
    with pytest.raises(RefusedError, match="0 viewers watch already"):
        await VideoGateway().watch(read_address("rtsp://127.0.0.1/x"), "v=0")


@pytest.mark.parametrize("offer", ["", "junk", "v=0\r\n", "v=0\r\nm=video x\r\n"])
async def test_a_malformed_offer_is_refused_and_leaves_no_viewer(offer):
    async with video() as (gateway, camera):
        with pytest.raises(RefusedError):
            await gateway.watch(read_address(camera.url), offer)
        assert (gateway.viewers, gateway.cameras) == (0, 0)


def send_rtp(port: int, stop: threading.Event) -> None:
    """Send pictures as RTP, by the library in the place of a camera."""
    with av.open(f"rtp://127.0.0.1:{port}", "w", format="rtp") as container:
        stream = container.add_stream(
            "libx264", rate=20, options={"preset": "ultrafast", "tune": "zerolatency"}
        )
        stream.width, stream.height, stream.pix_fmt, stream.gop_size = WIDTH, HEIGHT, "yuv420p", 10
        while not stop.wait(0.05):
            frame = av.VideoFrame.from_ndarray(draw(time(), 0.0, 0.0), format="rgb24")
            container.mux(stream.encode(frame))


async def test_rtp_is_played():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
    stop, gateway = threading.Event(), VideoGateway()
    sending = asyncio.create_task(asyncio.to_thread(send_rtp, port, stop))
    try:
        async with browser(gateway, f"rtp://127.0.0.1:{port}") as (track, _):
            picture = [await picture_of(track) for _ in range(5)][-1]
            assert abs(read_time(picture) - time()) < 10
    finally:
        stop.set()
        await sending
        await gateway.close()
