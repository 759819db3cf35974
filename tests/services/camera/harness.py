"""A ground station and a camera, or an autopilot with attached cameras, joined by one link."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.camera import (
    CameraDevice,
    CameraInformation,
    CameraMonitor,
    CameraServer,
    ImageCaptured,
    Storage,
    VideoStream,
)
from mavstack.services.command import CommandClient, CommandServer
from mavstack.services.message_request import MessageServer
from tests.services.network import GROUND, VEHICLE, Network

if TYPE_CHECKING:
    from mavstack.links import Impairment

CAMERA = Address(1, 100)
CAPS = common.CameraCapFlags
EVERYTHING = int(
    CAPS.CAPTURE_IMAGE
    | CAPS.CAPTURE_VIDEO
    | CAPS.HAS_MODES
    | CAPS.HAS_BASIC_ZOOM
    | CAPS.HAS_BASIC_FOCUS
    | CAPS.HAS_VIDEO_STREAM
    | CAPS.HAS_TRACKING_POINT
    | CAPS.HAS_TRACKING_RECTANGLE
)


class Camera(CameraDevice):
    """A camera with two streams and one storage, whose calls are recorded."""

    def __init__(self, information: CameraInformation) -> None:
        number = information.device_id
        super().__init__(
            information,
            streams=[
                VideoStream(1, 2, "rtsp://camera/1", "day", device_id=number),
                VideoStream(2, 2, "rtsp://camera/2", "heat", running=False, thermal=True, device_id=number),
            ],
        )
        self.images: list[int] = []
        self.calls: list[tuple] = []
        self.used = 100.0
        self.works = True
        self.target = None

    @property
    def storages(self):
        return [Storage(1, 1, total=1000.0, used=self.used, available=1000.0 - self.used, name="card")]

    @property
    def tracked(self):
        return self.target

    def capture(self, index, now):
        self.images.append(index)
        image = super().capture(index, now)
        return image if self.works else type(image)(index, success=False)

    def format_storage(self, storage, now):
        self.used = 0.0
        return True

    def reset_settings(self, now):
        self.zoom = self.focus = None
        return True

    def start_video(self, stream, now):
        self.calls.append(("video", stream))
        return self.works

    def set_streaming(self, stream, running, now):
        self.calls.append(("streaming", stream, running))
        return True

    def track(self, target, now):
        self.target = target
        return True


class CameraHarness:
    """The client side on the ground and a camera component; `attached` cameras are on the autopilot."""

    def __init__(
        self,
        *attached: int,
        capabilities: int = EVERYTHING,
        seed: int = 0,
        impairment: Impairment | None = None,
    ) -> None:
        self.network = Network(seed)
        self.address = VEHICLE if attached else CAMERA
        self.devices = [
            Camera(CameraInformation("Maker", "Model", capabilities=capabilities, device_id=number))
            for number in attached or (0,)
        ]
        self.device = self.devices[0]
        self.camera = self.network.node(self.address, self._setup)
        self.ground = self.network.node(GROUND)
        self.commands = self.ground.engine.add(CommandClient(GROUND, self.address))
        self.monitor = self.ground.engine.add(CameraMonitor(GROUND, self.address, self._begin))
        self.pipes = self.network.connect(self.ground, self.camera, impairment)

    def _setup(self, engine) -> None:
        commands = engine.add(CommandServer(self.address))
        messages = engine.add(MessageServer(self.address, commands))
        self.server = engine.add(CameraServer(self.address, self.devices, booted_at=self.network.now))
        self.server.answer(commands, messages)

    def _begin(self, operation, now: float) -> None:
        self.commands.begin(operation, now)
        self.ground.engine.touch(self.commands)

    def run(self, operation, timeout: float = 200.0):
        self._begin(operation, self.network.now)
        assert self.network.run(lambda: operation.done, timeout=timeout)
        return operation

    def let_pass(self, seconds: float) -> None:
        self.network.run(timeout=seconds)

    def press_button(self, count: int = 1) -> None:
        """Take images by the camera's own button."""
        for _ in range(count):
            self.server.capture(self.network.now, self.device.information.device_id)
            self.camera.engine.touch(self.server)
            self.let_pass(0.5)

    @property
    def reported(self) -> list[int]:
        """The indexes of the images that the monitor reported."""
        return [event.image.index for event in self.ground.events_of(ImageCaptured)]
