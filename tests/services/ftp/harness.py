"""An FTP client and server in a simulated network."""

from __future__ import annotations

from mavstack.services import Outgoing, Priority, earliest
from mavstack.services.ftp import FtpClient, FtpServer, MemoryStore
from tests.services.network import GROUND, VEHICLE, Network


class FtpHarness:
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

    def run(self, operation, timeout: float = 600.0):
        self.ground.engine.touch(self.client)
        assert self.network.run(lambda: operation.done, timeout=timeout)
        return operation

    def settle(self, timeout: float = 60.0) -> None:
        self.ground.engine.touch(self.client)
        self.network.run(lambda: not self.client.busy, timeout=timeout)


class Px4BurstServer(FtpServer):
    """Bursts without pacing, as PX4 over UDP: four packets per 1.25 ms, whatever the link carries."""

    TICK, PACKETS = 0.00125, 4

    def __init__(self, *args, **options) -> None:
        super().__init__(*args, **options)
        self._tick = None

    def bulk_messages(self, now, has_room):
        bursting = [session for session in self.sessions if session.burst is not None]
        if not bursting:
            self._tick = None
        elif self._tick is None or now >= self._tick:
            self._tick = now + self.TICK
            for session in bursting:
                yield from self._some_of(session, now)

    def _some_of(self, session, now):
        session.used_at = now
        for _ in range(self.PACKETS):
            if session.burst is not None:
                reply = self._next_burst_reply(session, session.burst, now)
                yield Outgoing(reply.to_message(*session.owner), session.owner, Priority.BULK)

    def next_timeout(self):
        return earliest(super().next_timeout(), self._tick)


class Px4BurstHarness(FtpHarness):
    def serve(self, engine) -> None:
        self.servers.append(engine.add(Px4BurstServer(self.vehicle_address, self.store)))

    vehicle_address = VEHICLE
