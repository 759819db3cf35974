"""MAVSDK's camera server against the camera client."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.links import open_link
from mavstack.node import Node
from tests.interop.mavsdk_peer import mavsdk_object, mavsdk_peer, needs_mavsdk

pytestmark = [pytest.mark.interop, needs_mavsdk]


async def test_camera_server() -> None:
    link = open_link("udpin://127.0.0.1:0")
    async with (
        Node(link) as node,
        mavsdk_peer(f"udpout://127.0.0.1:{link.address[1]}", "server", 1, 100) as server,
    ):
        photos = await server.stream("camera_server", "subscribe_take_photo")
        modes = await server.stream("camera_server", "subscribe_set_mode")
        await server.call("camera_server", "set_information", information())
        found = await node.wait_for_component(lambda info: info.address.component == 100, "the camera")
        read = await found.camera.get_information()
        assert (read.vendor, read.model, read.width) == ("Maker", "Model", 640)
        assert read.can(common.CameraCapFlags.CAPTURE_IMAGE)

        async def take() -> None:
            index = await photos.get()
            await server.call("camera_server", "respond_take_photo", 1, capture(index))

        image, _ = await asyncio.gather(found.camera.take_photo(timeout=20), take())
        assert image.success
        assert (image.latitude, image.url) == (pytest.approx(47.5), "http://camera/1.jpg")

        async def change() -> None:
            assert await modes.get() == "VIDEO"
            await server.call("camera_server", "respond_set_mode", 1)

        await asyncio.gather(found.camera.set_mode("video", wait=False, timeout=20), change())
        with pytest.raises(CommandDenied):
            await found.camera.start_video()


def information() -> dict:
    return mavsdk_object(
        "camera_server.Information",
        vendor_name="Maker",
        model_name="Model",
        firmware_version="1.2.3",
        focal_length_mm=3.0,
        horizontal_sensor_size_mm=3.6,
        vertical_sensor_size_mm=2.7,
        horizontal_resolution_px=640,
        vertical_resolution_px=480,
        lens_id=0,
        definition_file_version=0,
        definition_file_uri="",
        image_in_video_mode_supported=False,
        video_in_image_mode_supported=False,
    )


def capture(index: int) -> dict:
    return mavsdk_object(
        "camera_server.CaptureInfo",
        position=mavsdk_object(
            "camera_server.Position",
            latitude_deg=47.5,
            longitude_deg=8.5,
            absolute_altitude_m=500.0,
            relative_altitude_m=20.0,
        ),
        attitude_quaternion=mavsdk_object("camera_server.Quaternion", w=1.0, x=0.0, y=0.0, z=0.0),
        time_utc_us=1_700_000_000_000_000,
        is_success=True,
        index=index,
        file_url="http://camera/1.jpg",
    )
