"""A camera as a MAVLink component, and a ground station that takes pictures with it, over UDP."""

import asyncio

import mavstack
from mavstack.dialects import common
from mavstack.services.command import CommandRequest

CAMERA = common.MavComponent.CAMERA


async def camera() -> None:
    """Run the camera: an address, a message that can be requested, and the handler of a command."""
    type_ = common.MavType.CAMERA
    async with mavstack.Node("udpin://127.0.0.1:14590", system=1, component=CAMERA, type=type_) as node:
        node.publish(common.CameraInformation, lambda _: common.CameraInformation(model_name=b"Pinhole"))

        @node.on_command(common.MavCmd.IMAGE_START_CAPTURE)
        async def capture(request: CommandRequest) -> common.MavResult:
            interval, total = request.command.param2, int(request.command.param3)
            if not 0 < total <= 100:
                return common.MavResult.DENIED
            for number in range(total):
                node.send(common.CameraImageCaptured(image_index=number, capture_result=1))
                node.commands.progress(request, 100 * (number + 1) // total)
                await asyncio.sleep(interval)
            return common.MavResult.ACCEPTED

        await node.serve_forever()


async def photographer() -> None:
    """Run the ground station: find the camera, request its model, take three pictures."""
    async with mavstack.Node("udpout://127.0.0.1:14590") as node:
        component = await node.wait_for_component(lambda info: info.type == common.MavType.CAMERA, "a camera")
        information = await component.request_message(common.CameraInformation)
        print(information.model_name.rstrip(b"\0").decode(), "at", component.address)
        async with component.stream(common.CameraImageCaptured) as pictures:
            await component.command(common.MavCmd.IMAGE_START_CAPTURE, 0, 0.05, 3)
            print("pictures:", [picture.image_index for picture in pictures.drain()])


async def main() -> None:
    """Run both in one program."""
    running = asyncio.create_task(camera())
    await photographer()
    running.cancel()


asyncio.run(main())
