"""The cameras and gimbals of a vehicle: by heartbeat, and attached to the autopilot."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionUnsupported, InvalidArgumentError, RemoteTimeout
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services.camera import CameraDevice, CameraInformation
from mavstack.services.gimbal import GimbalInformation, GimbalMotion
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect

QUADROTOR, PX4 = common.MavType.QUADROTOR, common.MavAutopilot.PX4


def with_payloads(work) -> None:
    """Run work with a vehicle that has an attached camera, a camera component, and two gimbal managers."""

    async def run() -> None:
        network = MemoryNetwork()
        autopilot = Node(network.link(), system=1, component=1, type=QUADROTOR, autopilot=PX4)
        camera = Node(network.link(), system=1, component=101, type=common.MavType.CAMERA)
        other = Node(network.link(), system=2, component=100, type=common.MavType.CAMERA)
        autopilot.serve_camera(CameraDevice(CameraInformation("Maker", "Attached", device_id=2)))
        autopilot.serve_gimbal(GimbalMotion(GimbalInformation(1)))
        camera.serve_camera(CameraDevice(CameraInformation("Maker", "Own")))
        camera.serve_gimbal(GimbalMotion(GimbalInformation(3)))
        async with connect(network.link()) as connection, autopilot, other:
            vehicle = await connection.wait_for_vehicle()
            await work(vehicle, camera)
            await camera.close()

    run_virtually(run())


def test_cameras() -> None:
    async def work(vehicle, camera) -> None:
        with pytest.raises(ActionUnsupported, match="no camera of vehicle 1 is known"):
            vehicle.camera()
        await camera.open()
        own = await vehicle.wait_for_camera()
        assert own.address == (1, 101)
        assert vehicle.cameras == (own,)
        assert vehicle.camera() is vehicle.camera(101) is own
        assert await vehicle.find_cameras() == (own, vehicle.camera(2))
        assert (await vehicle.camera(2).get_information()).model == "Attached"
        assert (await own.get_information()).model == "Own"
        assert (await vehicle.camera(2).take_photo()).device_id == 2
        assert (await own.take_photo()).device_id == 0
        with pytest.raises(RemoteTimeout, match="camera 105 of vehicle 1"):
            await vehicle.wait_for_camera(105, timeout=1)
        with pytest.raises(InvalidArgumentError, match="1 to 255"):
            vehicle.camera(0)

    with_payloads(work)


def test_gimbals() -> None:
    async def work(vehicle, camera) -> None:
        await camera.open()
        await vehicle.wait_for_camera()
        found = await vehicle.find_gimbals()
        assert [(each.address.component, each.device_id) for each in found] == [(1, 1), (101, 3)]
        for gimbal in found:
            await gimbal.take_control()
            assert (await gimbal.point(pitch=-45)).pitch == pytest.approx(-45, abs=1)
        await vehicle.gimbal.center()

    with_payloads(work)


def test_a_vehicle_without_payloads() -> None:
    async def run() -> None:
        network = MemoryNetwork()
        autopilot = Node(network.link(), system=1, component=1, type=QUADROTOR, autopilot=PX4)
        _ = autopilot.message_server
        async with connect(network.link()) as connection, autopilot:
            vehicle = await connection.wait_for_vehicle()
            assert await vehicle.find_cameras() == ()
            assert await vehicle.find_gimbals() == ()

    run_virtually(run())
