"""A companion computer that offers a camera and a gimbal, and a ground station that uses both, over UDP."""

import asyncio

import mavstack
from mavstack.dialects import common
from mavstack.services.camera import CameraDevice, CameraInformation, CapturedImage
from mavstack.services.gimbal import GimbalMotion

CAMERA = common.MavComponent.CAMERA


class Pinhole(CameraDevice):
    """The driver of the camera: one method for each ability."""

    def __init__(self) -> None:
        image_and_modes = common.CameraCapFlags.CAPTURE_IMAGE | common.CameraCapFlags.HAS_MODES
        super().__init__(CameraInformation("Example", "Pinhole", capabilities=image_and_modes))

    def capture(self, index: int, now: float) -> CapturedImage:
        """Take an image, and say where it is."""
        return CapturedImage(index, time=now, latitude=47.3977, longitude=8.5456, url=f"/images/{index}.jpg")


async def companion() -> None:
    """Offer the camera and the gimbal."""
    type_ = common.MavType.CAMERA
    async with mavstack.Node("udpin://127.0.0.1:14592", system=1, component=CAMERA, type=type_) as node:
        node.serve_camera(Pinhole())
        node.serve_gimbal(GimbalMotion())
        await node.serve_forever()


async def ground_station() -> None:
    """Find the payload, point the gimbal, take three photos."""
    async with mavstack.Node("udpout://127.0.0.1:14592") as node:
        payload = await node.wait_for_component(lambda info: info.type == common.MavType.CAMERA, "a camera")
        information = await payload.camera.get_information()
        print(information.vendor, information.model, "at", payload.address)
        await payload.gimbal.take_control()
        attitude = await payload.gimbal.point(pitch=-45, yaw=20)
        print(f"gimbal at {attitude.pitch:.0f}, {attitude.yaw:.0f} degrees" if attitude else "gimbal")
        for _ in range(3):
            image = await payload.camera.take_photo()
            print("photo", image.index, image.url)


async def main() -> None:
    """Run both in one program."""
    running = asyncio.create_task(companion())
    await ground_station()
    running.cancel()


asyncio.run(main())
