"""A companion computer with a camera, its settings and its definition file, and a gimbal, for tests."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services.camera import CameraInformation, CameraSettingsServer, read_definition
from mavstack.services.ftp import FtpServer, MemoryStore
from mavstack.services.gimbal import GimbalInformation, GimbalMotion
from mavstack.sim.virtual import run_virtually
from tests.services.camera.harness import EVERYTHING, Camera
from tests.services.camera.test_definition import FILE


class PayloadPair:
    """A ground station and the payload."""

    def __init__(self, uri: str = "mftp:///camera.xml") -> None:
        network = MemoryNetwork()
        self.ground = Node(network.link())
        self.payload = Node(
            network.link(), system=1, component=common.MavComponent.CAMERA, type=common.MavType.CAMERA
        )
        information = CameraInformation("Maker", "T1", capabilities=EVERYTHING, definition_uri=uri)
        self.device = Camera(information)
        self.cameras = self.payload.serve_camera(self.device)
        self.gimbals = self.payload.serve_gimbal(
            GimbalMotion(GimbalInformation(1, vendor="Maker", model="G1")), GimbalMotion(GimbalInformation(2))
        )
        address = self.payload.address
        self.settings = self.payload.serve(CameraSettingsServer(address, read_definition(FILE)))
        store = MemoryStore({"camera.xml": FILE, "broken.xml": b"<mavlinkcamera>"})
        self.payload.serve(FtpServer(address, store))

    async def __aenter__(self):
        await self.ground.open()
        await self.payload.open()
        found = await self.ground.wait_for_component(lambda info: info.type == common.MavType.CAMERA)
        self.remote, self.camera, self.gimbal = found, found.camera, found.gimbal
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.payload.close()
        await self.ground.close()


def with_pair(work, **options) -> None:
    async def run() -> None:
        async with PayloadPair(**options) as pair:
            await work(pair)

    run_virtually(run())
