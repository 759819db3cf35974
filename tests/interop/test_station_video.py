"""Video in Chromium: streams that a simulated camera announces, by WebRTC from a gateway."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from contextlib import AbstractContextManager, contextmanager
from time import time
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from mavstack.dialects import common
from mavstack.services.camera.media import VideoStream
from mavstack.sim import BackgroundSimulator
from mavstack.sim.payloads.picture import read_time
from tests.interop.station import DESKTOP, PATIENT, StationPage, near, station_page, web_server
from tests.interop.whep_gateway import COLOURS, WhepGateway, whep_gateway
from tests.links.test_tcp import free_port
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

STREAMS = (
    VideoStream(1, 4, "rtsp://127.0.0.1:8554/front", "Front", width=320, height=180),
    VideoStream(2, 4, "rtsp://127.0.0.1:8554/thermal", "Infrared", thermal=True),
    VideoStream(3, 4, "javascript:window.isHacked=true", "Script"),
    VideoStream(4, 4, "http://user:word@127.0.0.1/live.mp4", "Secret"),
)
#: The addresses in the page that the gateway of a test has.
FOREIGN = ("http://127.0.0.1", "Failed to load resource", "Access to fetch")


@contextmanager
def camera_page(
    browser: Any, folder: Path, gateway: str, streams: tuple[VideoStream, ...] = STREAMS
) -> Iterator[StationPage]:
    """Show the video panel for a copter with a camera; the gateway is entered already."""
    simulator = BackgroundSimulator()
    vehicle = simulator.simulation.add("copter", camera=True, system=2)
    assert vehicle.camera is not None
    vars(vehicle.camera.device)["_streams"] = streams
    make_ready(simulator.simulation)
    with (
        simulator,
        web_server(folder, f"udpout://127.0.0.1:{simulator.port}") as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        shown.page.evaluate(
            "gateway => localStorage.setItem('mavstack.fly.videoGateway', JSON.stringify(gateway))", gateway
        )
        shown.page.route("**/api/video", lambda route: route.fulfill(json={"available": False}))
        shown.page.reload()
        shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
        shown.page.keyboard.press("]")
        shown.button("Video").click(timeout=PATIENT)
        yield shown
        shown.expect_problems(*FOREIGN)


def choose(shown: StationPage, name: str) -> None:
    source = shown.page.get_by_label("Source", exact=True)
    shown.wait_until(lambda: any(name in text for text in source.locator("option").all_inner_texts()))
    (label,) = [text for text in source.locator("option").all_inner_texts() if name in text]
    source.select_option(label=label)


def wait_for_movement(shown: StationPage, colour: tuple[int, int, int]) -> None:
    """Wait until the video shows its colour, at places that change."""
    video = shown.page.locator(".picture video")
    video.wait_for(timeout=PATIENT)
    before: np.ndarray | None = None

    def moves() -> bool:
        nonlocal before
        pixels = shown.pixels(video)
        last, before = before, pixels
        return near(pixels, colour, 70) > 500 and last is not None and bool(np.abs(pixels - last).max() > 80)

    shown.wait_until(moves)


def test_announced_streams_are_played_switched_stopped_and_played_again(browser: Any, tmp_path: Path) -> None:
    with (
        whep_gateway() as gateway,
        camera_page(browser, tmp_path, f"{gateway.url}/{{path}}/whep") as shown,
    ):
        choose(shown, "Front · 320")
        shown.button("Play").click()
        wait_for_movement(shown, COLOURS["front"])
        check_reconnect(shown, gateway)
        choose(shown, "Infrared · thermal")
        shown.wait_until(lambda: not gateway.peers)
        shown.button("Play").click()
        wait_for_movement(shown, COLOURS["thermal"])
        shown.button("Stop").click()
        shown.wait_until(lambda: not gateway.peers)
        assert shown.page.locator(".picture").count() == 0


def check_reconnect(shown: StationPage, gateway: WhepGateway) -> None:
    """Let the gateway end the connection: the page makes another one by itself."""
    before = gateway.requests.count(("POST", "front"))
    gateway.drop_all()
    shown.wait_until(lambda: gateway.requests.count(("POST", "front")) > before)
    wait_for_movement(shown, COLOURS["front"])
    shown.page.get_by_text("Connecting again").wait_for(state="detached", timeout=PATIENT)


def test_a_stream_that_comes_later_is_waited_for_until_it_is_stopped(browser: Any, tmp_path: Path) -> None:
    with whep_gateway() as gateway, camera_page(browser, tmp_path, f"{gateway.url}/none/whep") as shown:
        choose(shown, "Front")
        shown.button("Play").click()
        shown.wait_for("the gateway answered 404")
        shown.wait_until(lambda: gateway.requests.count(("POST", "none")) >= 3)
        shown.button("Stop").click()
        stopped = gateway.requests.count(("POST", "none"))
        shown.page.wait_for_timeout(4500)
        assert gateway.requests.count(("POST", "none")) <= stopped + 1


def test_addresses_that_are_no_video_are_not_opened(browser: Any, tmp_path: Path) -> None:
    with camera_page(browser, tmp_path, "http://127.0.0.1:9/{path}/whep") as shown:
        for name, text in (("Script", "no video that a browser"), ("Secret", "address with a password")):
            choose(shown, name)
            shown.wait_for(text)
            assert shown.button("Play").is_disabled()
        assert shown.page.evaluate("window.isHacked") is None


def mediamtx() -> str:
    """Return the path of MediaMTX, or skip."""
    found = os.environ.get("MEDIAMTX") or shutil.which("mediamtx")
    if found is None or shutil.which("ffmpeg") is None:
        pytest.skip("no mediamtx (PATH or MEDIAMTX) or no ffmpeg")
    return found


@contextmanager
def running(*command: str, **options: Any) -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen(command, text=True, **options) as process:
        try:
            yield process
        finally:
            process.terminate()


@contextmanager
def running_mediamtx(folder: Path, paths: str) -> Iterator[tuple[int, int]]:
    """Run MediaMTX with a configuration of its paths; yields the ports of RTSP and WHEP."""
    rtsp, webrtc, ice = free_port(), free_port(), free_port()
    configuration = folder / f"{rtsp}.yml"
    # Its other servers have fixed ports. Not every version has all, but each passes over strange variables.
    others = {f"MTX_{name}": "no" for name in ("RTMP", "HLS", "SRT", "MOQ")}
    configuration.write_text(
        f"rtspTransports: [tcp]\nrtspAddress: 127.0.0.1:{rtsp}\nwebrtcAddress: 127.0.0.1:{webrtc}\n"
        f"webrtcLocalUDPAddress: 127.0.0.1:{ice}\n{paths}",
        "utf-8",
    )
    options = {"cwd": folder, "env": os.environ | others, "stdout": subprocess.PIPE}
    with running(mediamtx(), str(configuration), **options) as process:
        assert process.stdout is not None
        assert any("[WebRTC]" in line for line in process.stdout), "MediaMTX ended"
        yield rtsp, webrtc


def filming(*target: str) -> AbstractContextManager[object]:
    """Run a camera: ffmpeg sends H.264."""
    source = ("-re", "-f", "lavfi", "-i", "testsrc=size=320x180:rate=20", "-pix_fmt", "yuv420p")
    codec = ("-c:v", "libx264", "-preset", "ultrafast", "-tune", "zerolatency", "-g", "20")
    return running("ffmpeg", "-loglevel", "error", *source, *codec, *target)


@contextmanager
def rtsp_camera(folder: Path) -> Iterator[VideoStream]:
    """Run a camera with an RTSP server."""
    with running_mediamtx(folder, "paths:\n  all_others:\n") as (port, _):
        address = f"rtsp://127.0.0.1:{port}/front"
        with filming("-f", "rtsp", "-rtsp_transport", "tcp", address):
            yield VideoStream(1, 1, address, "Front")


@contextmanager
def rtp_camera(_folder: Path) -> Iterator[VideoStream]:
    """Run a camera that sends RTP to a port."""
    port = free_port()
    with filming("-f", "rtp", "-payload_type", "96", f"rtp://127.0.0.1:{port}"):
        yield VideoStream(1, 1, str(port), "Front", type=common.VideoStreamType.RTPUDP)


@pytest.mark.parametrize("camera", [rtsp_camera, rtp_camera])
def test_mediamtx_plays_a_camera_with_the_configuration_that_the_page_shows(
    camera: Callable[[Path], AbstractContextManager[VideoStream]], browser: Any, tmp_path: Path
) -> None:
    mediamtx()
    with camera(tmp_path) as stream, camera_page(browser, tmp_path, "", (stream,)) as shown:
        choose(shown, "Front")
        paths = shown.page.locator("pre", has_text="paths:").inner_text(timeout=PATIENT)
        with running_mediamtx(tmp_path, paths) as (_, webrtc):
            gateway = shown.page.get_by_label("Gateway")
            gateway.fill(f"http://127.0.0.1:{webrtc}/{{path}}/whep")
            gateway.press("Enter")
            shown.button("Play").click()
            wait_for_movement(shown, (255, 255, 0))


def test_the_station_plays_a_camera_without_a_gateway(browser: Any, tmp_path: Path) -> None:
    """The camera of `mav sim --video` in Chromium, with the time in its picture."""
    link, port = free_port(), free_port()
    out = ("--out", f"tcpin://127.0.0.1:{link}")
    command = (sys.executable, "-m", "mavstack", "sim", "--video", str(port), *out)
    with (
        running(*command, stdout=subprocess.DEVNULL, stdin=subprocess.PIPE),
        web_server(tmp_path, f"tcpout://127.0.0.1:{link}?wait=yes") as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
        shown.page.keyboard.press("]")
        shown.button("Video").click(timeout=PATIENT)
        choose(shown, "camera")
        shown.button("Play").click()
        video = shown.page.locator(".picture video")
        video.wait_for(timeout=PATIENT)
        shown.wait_until(lambda: abs(read_time(shown.pixels(video).astype(np.uint8)) - time()) < 20)
        assert server.get("video") == {"available": True, "viewers": 1}
        shown.button("Stop").click()
        shown.wait_until(lambda: server.get("video")["viewers"] == 0)
