"""MAVSDK's camera and gimbal plugins with the payloads of a simulated vehicle."""

from __future__ import annotations

from contextlib import asynccontextmanager

import pytest

from mavstack.dialects import common
from mavstack.sim import Simulation
from tests.interop.mavsdk_peer import MavsdkError, mavsdk_peer, needs_mavsdk
from tests.interop.simulated import Flight
from tests.sim.running import running

pytestmark = [pytest.mark.interop, needs_mavsdk]

CAMERA = 100


@asynccontextmanager
async def equipped_flight(firmware: str):
    """Yield a simulated copter with a camera and a gimbal, discovered by MAVSDK, in real time."""
    simulation = Simulation()
    vehicle = simulation.add("copter", firmware, camera=True, gimbal=True)
    async with (
        running(simulation, "udpin://127.0.0.1:0", speed=1.0) as simulated,
        mavsdk_peer(f"udpout://127.0.0.1:{simulated.link.address[1]}") as ground,
    ):
        yield Flight(vehicle, ground, simulated)


async def test_camera() -> None:
    async with equipped_flight("px4") as flight:
        device = flight.vehicle.camera.device
        cameras = await flight.ground.stream("camera", "subscribe_camera_list")
        found = await cameras.wait_for(lambda heard: heard["cameras"])
        assert found["cameras"][0]["vendor_name"] == "Mavstack"
        assert found["cameras"][0]["component_id"] == CAMERA
        images = await flight.ground.stream("camera", "subscribe_capture_info")
        await flight.call_ok("camera", "set_mode", CAMERA, 1)
        await flight.call_ok("camera", "take_photo", CAMERA)
        image = await images.wait_for(lambda heard: heard["is_success"])
        assert image["position"]["latitude_deg"] == pytest.approx(47.3977, abs=1e-3)
        await flight.call_ok("camera", "start_photo_interval", CAMERA, 0.5)
        await images.wait_for(lambda heard: heard["index"] == 3)
        await flight.call_ok("camera", "stop_photo_interval", CAMERA)
        await flight.call_fails("DENIED|BUSY|ERROR", "camera", "start_video", CAMERA)
        await flight.call_ok("camera", "set_mode", CAMERA, 2)
        assert flight.vehicle.camera.server.mode() == common.CameraMode.VIDEO
        await flight.call_ok("camera", "start_video", CAMERA)
        await flight.call_ok("camera", "stop_video", CAMERA)
        await flight.call_ok("camera", "zoom_range", CAMERA, 40.0)
        await flight.call_ok("camera", "focus_range", CAMERA, 60.0)
        assert (device.zoom, device.focus) == (40.0, 60.0)
        await flight.call_ok("camera", "track_point", CAMERA, 0.5, 0.5, 0.1)
        assert device.tracked is not None
        await flight.call_ok("camera", "track_rectangle", CAMERA, 0.2, 0.2, 0.6, 0.6)
        await flight.call_ok("camera", "track_stop", CAMERA)
        await flight.call_ok("camera", "start_video_streaming", CAMERA, 1)
        await flight.call_ok("camera", "stop_video_streaming", CAMERA, 1)
        await flight.call_ok("camera", "format_storage", CAMERA, 1)
        assert device.used == 0.0
        storages = await flight.ground.stream("camera", "subscribe_storage")
        await storages.wait_for(lambda heard: heard["storage"]["total_storage_mib"] == 4096.0)


@pytest.mark.parametrize("firmware", ["px4", "ardupilot"])
async def test_gimbal(firmware: str) -> None:
    async with equipped_flight(firmware) as flight:
        listed = await flight.ground.stream("gimbal", "subscribe_gimbal_list")
        found = await listed.wait_for(lambda heard: heard["gimbals"])
        gimbal = found["gimbals"][0]
        assert gimbal["vendor_name"] == "Mavstack"
        number = gimbal["gimbal_id"]
        if firmware == "px4":
            with pytest.raises(MavsdkError, match=r"DENIED|ERROR"):
                await flight.call("gimbal", "set_angles", number, 0.0, -30.0, 0.0, 0, 0)
        await flight.call_ok("gimbal", "take_control", number, 1)
        controls = await flight.ground.stream("gimbal", "subscribe_control_status")
        await controls.wait_for(lambda heard: heard["control_mode"] == "PRIMARY")
        attitudes = await flight.ground.stream("gimbal", "subscribe_attitude")
        await flight.call_ok("gimbal", "set_angles", number, 0.0, -30.0, 20.0, 0, 0)
        await attitudes.wait_for(
            lambda heard: (
                heard["euler_angle_forward"]["pitch_deg"] == pytest.approx(-30, abs=1)
                and heard["euler_angle_forward"]["yaw_deg"] == pytest.approx(20, abs=1)
            )
        )
        await flight.call_ok("gimbal", "set_angular_rates", number, 0.0, -20.0, 0.0, 0, 0)
        await attitudes.wait_for(lambda heard: heard["euler_angle_forward"]["pitch_deg"] < -60)
        await flight.call_ok("gimbal", "set_angles", number, 0.0, -10.0, 90.0, 1, 1)  # locked, streamed
        await attitudes.wait_for(
            lambda heard: heard["euler_angle_north"]["yaw_deg"] == pytest.approx(90, abs=2)
        )
        latitude, longitude, _ = flight.place(-200, 0)
        await flight.call_ok("gimbal", "set_roi_location", number, latitude, longitude, 488.0)
        await attitudes.wait_for(lambda heard: abs(heard["euler_angle_north"]["yaw_deg"]) > 177)
        await flight.call_ok("gimbal", "release_control", number)
        await controls.wait_for(lambda heard: heard["control_mode"] == "NONE")
