"""MAVProxy's camera and gimbal commands with the payloads of a simulated vehicle."""

from __future__ import annotations

from contextlib import asynccontextmanager

import pytest

from mavstack.dialects import common
from mavstack.sim import Simulation
from mavstack.sim.payloads.camera import IMAGE_SIZES
from tests.interop.mavproxy import RETRY_TIMEOUT, TIMEOUT, mavproxy, needs_mavproxy
from tests.interop.test_sim_mavproxy import MavproxyFlight
from tests.sim.running import running

pytestmark = [pytest.mark.interop, pytest.mark.timeout(240), needs_mavproxy]


class EquippedFlight(MavproxyFlight):
    """A vehicle with payloads, and the console of MAVProxy."""

    flying_speed = 1.0  # nothing flies: everything is conversation

    async def send_until(self, line: str, condition) -> None:
        """Send a line, again if need be, until a condition holds; only for lines that may act twice."""
        for left in (2, 1, 0):
            self.ground.send_line(line)
            try:
                return await self.wait_until(condition, RETRY_TIMEOUT if left else TIMEOUT)
            except AssertionError:
                if not left:
                    raise
        raise AssertionError("not reached")


@asynccontextmanager
async def equipped_flight(firmware: str, directory):
    """Yield a simulated copter with a camera and a gimbal, and MAVProxy with its camera module."""
    simulation = Simulation()
    vehicle = simulation.add("copter", firmware, camera=True, gimbal=True)
    async with (
        running(simulation, "udpin://127.0.0.1:0", speed=1.0) as simulated,
        mavproxy(simulated.link.address[1], directory, modules="cmdlong,link,output,ftp") as console,
    ):
        flight = EquippedFlight(vehicle, console, simulated)
        await console.wait_for_output("Detected vehicle 1:1")
        await flight.send_and_wait("module load camera", "Loaded module camera")
        await console.send_until_answered("camera discover", "discovery requested")
        await console.send_until_answered("camera status", "Mavstack Simulated camera (1:100)")
        yield flight


async def test_camera(tmp_path) -> None:
    async with equipped_flight("px4", tmp_path) as flight:
        camera, device, ground = flight.vehicle.camera, flight.vehicle.camera.device, flight.ground
        await ground.send_until_answered("camera info", "resolution=5472x3648", "camera.xml.xz")
        await flight.send_until("camera mode photo", lambda: camera.server.mode() == common.CameraMode.IMAGE)
        await flight.send_until("camera photo", lambda: camera.images >= 1)
        before = camera.images
        await flight.send_until("camera photo 0.5 2", lambda: camera.images >= before + 2)
        await flight.send_until("camera mode video", lambda: camera.server.mode() == common.CameraMode.VIDEO)
        used = device.storages[0].used + 2 * IMAGE_SIZES[0]
        await flight.send_until("camera record start", lambda: device.storages[0].used > used)
        ground.send_line("camera record stop")
        await flight.send_until("camera zoom 40", lambda: device.zoom == 40.0)
        await flight.send_until("camera focus 60", lambda: device.focus == 60.0)
        await ground.send_until_answered("camera streams", "rtsp://127.0.0.1:8554/camera")
        await ground.send_until_answered("camera params", "CAM_PHOTOFMT 0")  # the definition came over FTP
        await flight.send_until("camera param CAM_VIDRES 0", lambda: camera.settings["CAM_VIDRES"] == 0)
        assert not ground.errors()


async def test_gimbal(tmp_path) -> None:
    async with equipped_flight("ardupilot", tmp_path) as flight:
        gimbal, ground = flight.vehicle.gimbal, flight.ground

        def attitude():
            return gimbal.advance(flight.vehicle.now, 0.0)

        await flight.send_until(
            "camera mount angle -30 20", lambda: attitude().pitch == pytest.approx(-30, abs=1)
        )
        assert attitude().yaw == pytest.approx(20, abs=1)
        await flight.send_until("camera mount rate -20 0", lambda: attitude().pitch < -50)
        await flight.send_until("camera mount center", lambda: attitude().pitch == pytest.approx(0, abs=1))
        assert not ground.errors()


async def test_px4_needs_gimbal_control(tmp_path) -> None:
    """MAVProxy does not take control of a gimbal, which PX4's gimbal manager requires."""
    async with equipped_flight("px4", tmp_path) as flight:
        flight.ground.send_line("camera mount angle -30 20")
        await flight.ground.wait_for_output("DO_GIMBAL_MANAGER_PITCHYAW: DENIED")
