"""Video in Chromium: streams that a simulated camera announces, by WebRTC from a gateway."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from time import time
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from mavstack.dialects import common
from mavstack.services.camera.media import VideoStream
from mavstack.sim import BackgroundSimulator
from mavstack.sim.payloads.picture import read_time
from tests.interop.station import DESKTOP, PATIENT, StationPage, StationServer, near, station_page, web_server
from tests.interop.whep_gateway import COLOURS, WhepGateway, whep_gateway
from tests.links.test_tcp import free_port
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

av = pytest.importorskip("av")
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


def play(shown: StationPage, name: str) -> None:
    shown.button(f"Play {name}").click(timeout=PATIENT)


def wait_for_movement(shown: StationPage, colour: tuple[int, int, int], index: int = 0) -> None:
    """Wait until the video shows its colour, at places that change."""
    video = shown.page.locator(".picture video").nth(index)
    video.wait_for(timeout=PATIENT)
    before: np.ndarray | None = None

    def moves() -> bool:
        nonlocal before
        pixels = shown.pixels(video)
        last, before = before, pixels
        return near(pixels, colour, 70) > 500 and last is not None and bool(np.abs(pixels - last).max() > 80)

    shown.wait_until(moves)


def test_announced_streams_are_played_beside_each_other_and_closed(browser: Any, tmp_path: Path) -> None:
    with (
        whep_gateway() as gateway,
        camera_page(browser, tmp_path, f"{gateway.url}/{{path}}/whep") as shown,
    ):
        shown.wait_for("320\u00d7180")
        play(shown, "Front")
        wait_for_movement(shown, COLOURS["front"])
        check_reconnect(shown, gateway)
        play(shown, "Infrared")
        wait_for_movement(shown, COLOURS["thermal"], 1)
        wait_for_movement(shown, COLOURS["front"])
        left, right = (shown.page.locator(".picture").nth(each).bounding_box() for each in (0, 1))
        assert left["y"] == right["y"], "they are beside each other"
        assert left["x"] + left["width"] <= right["x"]
        shown.button("Full screen").click()
        shown.page.wait_for_function("document.fullscreenElement?.className.includes('pictures')")
        shown.page.evaluate("document.exitFullscreen()")
        shown.button("Close Front").click()
        shown.wait_until(lambda: len(gateway.peers) == 1)
        wait_for_movement(shown, COLOURS["thermal"])
        shown.button("Close Infrared").click()
        shown.wait_until(lambda: not gateway.peers)
        assert shown.page.locator(".picture").count() == 0


def check_reconnect(shown: StationPage, gateway: WhepGateway) -> None:
    """Let the gateway end the connection: the page makes another one by itself."""
    before = gateway.requests.count(("POST", "front"))
    gateway.drop_all()
    shown.wait_until(lambda: gateway.requests.count(("POST", "front")) > before)
    wait_for_movement(shown, COLOURS["front"])
    shown.page.get_by_text("Connecting again").wait_for(state="detached", timeout=PATIENT)


@pytest.mark.nightly
def test_a_stream_that_comes_later_is_waited_for_until_it_is_stopped(browser: Any, tmp_path: Path) -> None:
    with whep_gateway() as gateway, camera_page(browser, tmp_path, f"{gateway.url}/none/whep") as shown:
        play(shown, "Front")
        shown.wait_for("the gateway answered 404")
        shown.wait_until(lambda: gateway.requests.count(("POST", "none")) >= 3)
        shown.button("Close Front").click()
        stopped = gateway.requests.count(("POST", "none"))
        shown.page.wait_for_timeout(4500)
        assert gateway.requests.count(("POST", "none")) <= stopped + 1


def test_addresses_that_are_no_video_are_not_opened(browser: Any, tmp_path: Path) -> None:
    with camera_page(browser, tmp_path, "http://127.0.0.1:9/{path}/whep") as shown:
        for name, text in (("Script", "no video that a browser"), ("Secret", "address with a password")):
            shown.wait_for(text)
            assert shown.button(f"Play {name}").is_disabled()
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
        paths = shown.page.locator("pre", has_text="paths:").inner_text(timeout=PATIENT)
        with running_mediamtx(tmp_path, paths) as (_, webrtc):
            gateway = shown.page.get_by_label("Gateway")
            gateway.fill(f"http://127.0.0.1:{webrtc}/{{path}}/whep")
            gateway.press("Enter")
            play(shown, "Front")
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
        play(shown, "camera")
        video = shown.page.locator(".picture video")
        video.wait_for(timeout=PATIENT)
        shown.wait_until(lambda: abs(read_time(shown.pixels(video).astype(np.uint8)) - time()) < 20)
        assert server.get("video") == {"available": True, "viewers": 1}
        check_recording(shown, server, tmp_path)
        shown.button("Close camera").click()
        shown.wait_until(lambda: server.get("video")["viewers"] == 0)


def check_recording(shown: StationPage, server: StationServer, folder: Path) -> None:
    """Record the camera that is shown, and find the file in the view Logs."""
    shown.button("Record camera").click()
    shown.wait_for("Recording 0:")
    shown.wait_until(lambda: server.get("video/recordings")[0]["seconds"] > 1)
    shown.button("End the recording of camera").click()
    shown.wait_for("is among the recordings in the view Logs")
    (recorded,) = server.get("video/recordings")
    assert recorded["name"].startswith("copter-1-camera-20")
    assert not recorded["running"]
    shown.page.get_by_role("link", name="Logs").click()
    with shown.page.expect_download() as download:
        shown.page.get_by_role("link", name=f"Download {recorded['name']}").click()
    data = Path(download.value.path()).read_bytes()
    assert data == (folder / recorded["name"]).read_bytes()
    with av.open(str(folder / recorded["name"])) as container:
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    assert abs(read_time(pictures[-1]) - time()) < 60
    shown.page.get_by_role("link", name="Fly").click()
    shown.button("Video").click(timeout=PATIENT)
    play(shown, "camera")


def test_h265_is_explained_in_the_place_of_a_black_picture(browser: Any, tmp_path: Path) -> None:
    stream = VideoStream(1, 1, "rtsp://127.0.0.1:8554/hevc", "Hevc", encoding=common.VideoStreamEncoding.H265)
    with whep_gateway() as gateway:
        url = f"{gateway.url}/{{path}}/whep"
        with camera_page(browser, tmp_path, url, (stream,)) as shown:
            shown.page.evaluate(
                "RTCRtpReceiver.getCapabilities = () => ({ codecs: [{ mimeType: 'video/H264' }] })"
            )
            play(shown, "Hevc")
            shown.wait_for("Set the encoding of the camera to H.264")
            assert shown.page.locator(".picture video").count() == 0
            assert gateway.requests == []
