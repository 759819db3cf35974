"""A ground station and a gimbal manager on a companion computer, joined by one link."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.command import CommandClient, CommandServer
from mavstack.services.gimbal import GimbalInformation, GimbalManagerServer, GimbalMonitor, GimbalMotion
from mavstack.services.message_request import MessageServer
from tests.services.network import GROUND, VEHICLE, Network

if TYPE_CHECKING:
    from mavstack.links import Impairment
    from tests.services.network import Node

MANAGER = Address(1, 191)


class GimbalHarness:
    """The client side on the ground, the server with one gimbal per device id, and an autopilot."""

    def __init__(self, *device_ids: int, seed: int = 0, impairment: Impairment | None = None) -> None:
        self.network = Network(seed)
        self.device_ids = device_ids or (1,)
        self.manager = self.network.node(MANAGER, self._setup)
        self.ground = self.network.node(GROUND)
        self.commands = self.ground.engine.add(CommandClient(GROUND, MANAGER))
        self.monitor = self.ground.engine.add(GimbalMonitor(GROUND, MANAGER))
        self.pipes = self.network.connect(self.ground, self.manager, impairment)
        self.autopilot: Node | None = None

    def _setup(self, engine) -> None:
        self.devices = [GimbalMotion(GimbalInformation(number)) for number in self.device_ids]
        commands = engine.add(CommandServer(MANAGER))
        messages = engine.add(MessageServer(MANAGER, commands))
        self.server = engine.add(GimbalManagerServer(MANAGER, self.devices, booted_at=self.network.now))
        self.server.answer(commands, messages, now=self.network.now)

    def run(self, operation, timeout: float = 120.0):
        self.commands.begin(operation, self.network.now)
        self.ground.engine.touch(self.commands)
        assert self.network.run(lambda: operation.done, timeout=timeout)
        return operation

    def let_pass(self, seconds: float) -> None:
        self.network.run(timeout=seconds)

    def fly(self, heading: float, *, latitude: float = 47.0, longitude: float = 8.0, height: float = 100.0):
        """Let the autopilot broadcast a pose."""
        if self.autopilot is None:
            self.autopilot = self.network.node(VEHICLE)
            self.network.connect(self.autopilot, self.manager)
        message = common.GlobalPositionInt(
            lat=round(latitude * 1e7),
            lon=round(longitude * 1e7),
            alt=round((height + 400) * 1e3),
            relative_alt=round(height * 1e3),
            hdg=round(heading % 360 * 100),
        )
        self.autopilot.engine.send(message, self.network.now)
        self.network.run(timeout=0.01)

    def send(self, message) -> None:
        self.ground.engine.send(message, self.network.now)
        self.network.run(timeout=0.01)
