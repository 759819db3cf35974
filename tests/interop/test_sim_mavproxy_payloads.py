"""MAVProxy's camera and gimbal commands with the payloads of a simulated vehicle."""

from __future__ import annotations

from contextlib import asynccontextmanager

import pytest

from mavstack.dialects import common
from mavstack.sim import Simulation
from mavstack.sim.payloads.camera import IMAGE_SIZES
from tests.interop.mavproxy import mavproxy, needs_mavproxy
from tests.interop.test_sim_mavproxy import MavproxyFlight
from tests.sim.running import running

pytestmark = [pytest.mark.interop, pytest.mark.timeout(240), needs_mavproxy]


@asynccontextmanager
async def equipped_flight(firmware: str, directory):
    """Yield a simulated copter with a camera and a gimbal, and MAVProxy with its camera module."""
    simulation = Simulation()
    vehicle = simulation.add("copter", firmware, camera=True, gimbal=True)
    async with (
        running(simulation, "udpin://127.0.0.1:0", speed=1.0) as simulated,
        mavproxy(simulated.link.address[1], directory, modules="cmdlong,link,output,ftp") as console,
    ):
        flight = MavproxyFlight(vehicle, console, simulated)
        flight.flying_speed = 1.0  # nothing flies: everything is conversation
        await console.wait_for_output("Detected vehicle 1:1")
        await flight.send_and_wait("module load camera", "Loaded module camera")
        await console.send_until_answered("camera discover", "discovery requested")
        await console.send_until_answered("camera status", "Mavstack Simulated camera (1:100)")
        yield flight


async def test_camera(tmp_path) -> None:
    async with equipped_flight("px4", tmp_path) as flight:
        camera, device, ground = flight.vehicle.camera, flight.vehicle.camera.device, flight.ground
        await ground.send_until_answered("camera info", "resolution=5472x3648", "camera.xml.xz")
        ground.send_line("camera mode photo")
        await flight.wait_until(lambda: camera.server.mode() == common.CameraMode.IMAGE)
        ground.send_line("camera photo")
        await flight.wait_until(lambda: camera.images == 1)
        ground.send_line("camera photo 0.5 2")
        await flight.wait_until(lambda: camera.images == 3)
        ground.send_line("camera mode video")
        await flight.wait_until(lambda: camera.server.mode() == common.CameraMode.VIDEO)
        ground.send_line("camera record start")
        await flight.wait_until(lambda: device.storages[0].used > 3 * IMAGE_SIZES[0])
        ground.send_line("camera record stop")
        ground.send_line("camera zoom 40")
        ground.send_line("camera focus 60")
        await flight.wait_until(lambda: (device.zoom, device.focus) == (40.0, 60.0))
        await ground.send_until_answered("camera streams", "rtsp://127.0.0.1:8554/camera")
        await ground.send_until_answered("camera params", "CAM_PHOTOFMT 0")  # the definition came over FTP
        ground.send_line("camera param CAM_VIDRES 0")
        await flight.wait_until(lambda: camera.settings["CAM_VIDRES"] == 0)
        assert not ground.errors()


async def test_gimbal(tmp_path) -> None:
    async with equipped_flight("ardupilot", tmp_path) as flight:
        gimbal, ground = flight.vehicle.gimbal, flight.ground

        def attitude():
            return gimbal.advance(flight.vehicle.now, 0.0)

        ground.send_line("camera mount angle -30 20")
        await flight.wait_until(lambda: attitude().pitch == pytest.approx(-30, abs=1))
        assert attitude().yaw == pytest.approx(20, abs=1)
        ground.send_line("camera mount rate -20 0")
        await flight.wait_until(lambda: attitude().pitch < -50)
        ground.send_line("camera mount center")
        await flight.wait_until(lambda: attitude().pitch == pytest.approx(0, abs=1))
        assert not ground.errors()


async def test_px4_needs_gimbal_control(tmp_path) -> None:
    """MAVProxy does not take control of a gimbal, which PX4's gimbal manager requires."""
    async with equipped_flight("px4", tmp_path) as flight:
        flight.ground.send_line("camera mount angle -30 20")
        await flight.ground.wait_for_output("DO_GIMBAL_MANAGER_PITCHYAW: DENIED")
