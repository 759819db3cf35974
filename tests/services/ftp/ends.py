"""Both ends of a file transfer, in a network."""

from __future__ import annotations

from mavstack.services.ftp import FtpClient, FtpServer, MemoryStore
from tests.services.network import GROUND, VEHICLE, Network


class Ends:
    def __init__(
        self, seed: int = 0, store=None, impairment=None, *, paced=True, connect=True, **link
    ) -> None:
        self.store = store if store is not None else MemoryStore()
        self.network = Network(seed)
        self.servers = []
        self.paced = paced
        self.vehicle = self.network.node(VEHICLE, self.serve)
        self.ground = self.network.node(GROUND)
        self.client = self.ground.engine.add(FtpClient(GROUND, VEHICLE))
        if connect:
            self.pipes = self.network.connect(self.ground, self.vehicle, impairment, **link)

    def serve(self, engine) -> None:
        self.servers.append(engine.add(FtpServer(VEHICLE, self.store, paced=self.paced)))

    @property
    def server(self) -> FtpServer:
        return self.servers[-1]

    @property
    def now(self) -> float:
        return self.network.now

    def run(self, operation, limit: float = 600.0):
        self.ground.engine.touch(self.client)
        assert self.network.run(lambda: operation.done, limit=limit)
        return operation

    def settle(self, limit: float = 60.0) -> None:
        self.ground.engine.touch(self.client)
        self.network.run(lambda: not self.client.busy, limit=limit)
