"""The camera and the gimbal of simulated vehicles, through the vehicle API, in virtual time."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, RemoteDenied
from mavstack.links import MemoryNetwork
from mavstack.services.mission import MissionItem
from mavstack.sim import Simulation
from mavstack.sim.payloads.camera import CAPACITY
from mavstack.sim.payloads.definition import simulated_definition
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.running import make_ready, reduce_telemetry, running

CMD = common.MavCmd


def with_vehicle(work, firmware: str = "px4", *, ready: bool = False) -> None:
    """Run work with a simulated copter that has a camera and a gimbal."""

    async def run() -> None:
        simulation, network = Simulation(seed=3), MemoryNetwork()
        simulated = simulation.add("copter", firmware, camera=True, gimbal=True)
        reduce_telemetry(simulated)
        if ready:
            make_ready(simulation)
        async with running(simulation, network.link()), connect(network.link()) as connection:
            vehicle = await connection.wait_for_vehicle()
            await work(vehicle, simulated)

    run_virtually(run())


def test_images_have_the_place_of_the_vehicle() -> None:
    async def work(vehicle, simulated) -> None:
        camera = await vehicle.wait_for_camera()
        assert camera.address == (1, 100)
        image = await camera.take_photo()
        here = simulated.body.home
        assert (image.latitude, image.longitude) == pytest.approx((here.latitude, here.longitude), abs=1e-4)
        assert image.altitude == pytest.approx(here.altitude, abs=3)
        assert image.time == pytest.approx(simulated.now, abs=3)
        assert simulated.camera.images == 1
        (storage,) = await camera.list_storages()
        assert storage.used == 8.0

    with_vehicle(work)


def test_the_camera_looks_where_the_gimbal_points() -> None:
    async def work(vehicle, simulated) -> None:
        camera = await vehicle.wait_for_camera()
        assert (await camera.get_information()).gimbal_device_id == 1
        await vehicle.gimbal.take_control()
        await vehicle.gimbal.point(pitch=-90)
        w, _, y, _ = (await camera.take_photo()).attitude
        assert abs(y / w) == pytest.approx(1.0, abs=0.03)

    with_vehicle(work)


def test_a_recording_fills_the_storage() -> None:
    async def work(vehicle, simulated) -> None:
        camera = await vehicle.wait_for_camera()
        await camera.set_mode("video")
        await camera.start_video()
        await asyncio.sleep(10)
        (storage,) = await camera.list_storages()
        assert storage.used == pytest.approx(40, abs=6)
        await camera.stop_video()
        simulated.camera.device.used = CAPACITY
        with pytest.raises(CommandDenied, match="VIDEO_START_CAPTURE on 1/100 failed: FAILED"):
            await camera.start_video()
        await camera.set_mode("photo")
        with pytest.raises(RemoteDenied, match="the capture failed"):
            await camera.take_photo()
        await camera.format_storage()
        await camera.take_photo()

    with_vehicle(work)


def test_settings_and_modes_belong_together() -> None:
    async def work(vehicle, simulated) -> None:
        camera = await vehicle.wait_for_camera()
        definition = await camera.settings.load()
        assert definition == simulated_definition()
        await camera.settings.set("CAM_MODE", "Video")
        assert (await camera.get_status()).mode == common.CameraMode.VIDEO
        await camera.set_mode("photo")
        assert await camera.settings.get("CAM_MODE") == 0
        await camera.settings.set("CAM_PHOTOFMT", "Raw")
        await camera.take_photo()
        assert (await camera.list_storages())[0].used == 40.0
        await camera.reset_settings()
        assert await camera.settings.get("CAM_PHOTOFMT") == 0

    with_vehicle(work)


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_the_gimbal_is_managed_by_the_autopilot(firmware: str) -> None:
    async def work(vehicle, simulated) -> None:
        (gimbal,) = await vehicle.find_gimbals()
        assert (gimbal.address, gimbal.device_id) == ((1, 1), 1)
        if firmware == "px4":
            with pytest.raises(CommandDenied):
                await gimbal.point(-10, wait=False)
            await gimbal.take_control()
        attitude = await gimbal.point(pitch=-45, yaw=60)
        assert (attitude.pitch, attitude.yaw) == pytest.approx((-45, 60), abs=1)
        await gimbal.set_roi(47.4977418, 8.5455940, 0.0)  # far north
        await asyncio.sleep(3)
        assert gimbal.attitude.heading == pytest.approx(0, abs=2)
        await gimbal.clear_roi()
        await asyncio.sleep(3)
        assert gimbal.attitude.yaw == pytest.approx(0, abs=2)

    with_vehicle(work, firmware)


def test_the_payloads_survive_a_reboot_of_the_autopilot() -> None:
    async def work(vehicle, simulated) -> None:
        camera = await vehicle.wait_for_camera()
        await camera.take_photo()
        simulated.reboot()
        await asyncio.sleep(8)
        assert (await camera.get_capture_status()).image_count == 1
        assert (await camera.take_photo()).index == 1
        await vehicle.gimbal.take_control()
        await vehicle.gimbal.point(pitch=-30)

    with_vehicle(work)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_a_mission_takes_images_with_the_camera(firmware: str) -> None:
    async def work(vehicle, simulated) -> None:
        await vehicle.wait_until_ready()
        home = [MissionItem.waypoint(47.3977418, 8.5455940, 0.0)] if firmware == "ardupilot" else []
        items = [
            *home,
            MissionItem.takeoff(15.0),
            MissionItem(CMD.DO_SET_CAM_TRIGG_DIST, param1=10.0, frame=common.MavFrame.MISSION),
            MissionItem.waypoint(47.3982418, 8.5455940, 15.0),
            MissionItem(CMD.DO_SET_CAM_TRIGG_DIST, param1=0.0, frame=common.MavFrame.MISSION),
            MissionItem.return_to_launch(),
        ]
        camera = await vehicle.wait_for_camera()
        async with camera.images() as images:
            await vehicle.mission.upload(items)
            await vehicle.mission.fly()
            taken = [event.image for event in images.drain()]
        assert [image.index for image in taken] == list(range(len(taken)))
        assert 4 <= len(taken) <= 8
        assert taken[-1].latitude > taken[0].latitude
        assert all(image.relative_altitude == pytest.approx(15, abs=3) for image in taken[1:])

    with_vehicle(work, firmware, ready=True)


def test_vehicles_without_payloads_have_none() -> None:
    simulation = Simulation()
    vehicle = simulation.add()
    assert (vehicle.camera, vehicle.gimbal) == (None, None)
