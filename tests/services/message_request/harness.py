"""A vehicle and a ground station joined by a link, for the tests of requests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.command import CommandClient, CommandServer
from mavstack.services.message_request import MessageServer
from tests.services.network import GROUND, VEHICLE, Network

if TYPE_CHECKING:
    from mavstack.links import Impairment
    from mavstack.services import Operation


class RequestHarness:
    """A vehicle and a ground station.

    If `old`, the vehicle has no message server and knows only the commands that `support` adds.
    """

    def __init__(
        self, seed: int = 0, impairment: Impairment | None = None, *, old: bool = False, **link
    ) -> None:
        self.network = Network(seed, keep_packets=True)
        self.old = old
        self.vehicle = self.network.node(VEHICLE, self.setup)
        self.ground = self.network.node(GROUND)
        self.client = self.ground.engine.add(CommandClient(GROUND, VEHICLE))
        self.pipes = self.network.connect(self.ground, self.vehicle, impairment, **link)

    def setup(self, engine) -> None:
        self.commands = engine.add(CommandServer(VEHICLE))
        if not self.old:
            self.messages = engine.add(MessageServer(VEHICLE, self.commands))
            self.provide()

    def provide(self) -> None:
        now = self.network.now
        self.messages.provide(common.HomePosition, lambda _: common.HomePosition(altitude=584_000))
        self.messages.provide(common.Attitude, lambda _: common.Attitude(roll=0.5), interval=0.25, now=now)
        self.messages.provide(common.VfrHud, lambda _: None)

    def run(self, operation: Operation, timeout: float = 120.0) -> Operation:
        self.begin(operation)
        assert self.network.run(lambda: operation.done, timeout=timeout), "it hangs"
        return operation

    def begin(self, operation: Operation) -> Operation:
        self.client.begin(operation, self.network.now)
        self.ground.engine.touch(self.client)
        return operation

    def run_for(self, seconds: float) -> None:
        self.network.run(timeout=seconds)

    def received(self, kind: type) -> list:
        return [packet.message for packet in self.ground.received if isinstance(packet.message, kind)]

    def received_commands(self) -> list[int]:
        kinds = common.CommandLong | common.CommandInt
        return [int(p.message.command) for p in self.vehicle.received if isinstance(p.message, kinds)]
