"""Scripted components on a memory network, which send HEARTBEAT and the time since their boot."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect

TYPE, AUTOPILOT = common.MavType, common.MavAutopilot
#: The interval at which a peer sends its messages, in seconds.
SEND_INTERVAL = 0.5


class Peer:
    """A component that sends HEARTBEAT and, if it has an `uptime`, ATTITUDE with its time since boot."""

    def __init__(
        self,
        network,
        system=1,
        component=1,
        *,
        type=TYPE.QUADROTOR,  # noqa: A002 (HEARTBEAT's name for it)
        autopilot=AUTOPILOT.ARDUPILOTMEGA,
        uptime=100.0,
    ) -> None:
        self.node = Node(network.link(), system=system, component=component, heartbeat=False)
        self.type, self.autopilot, self.uptime = type, autopilot, uptime
        self.quiet = False
        self._task = None

    async def start(self):
        await self.node.open()
        self._task = asyncio.create_task(self._send_periodically())
        return self

    async def stop(self):
        """Stop sending and close the links."""
        if self._task is not None:
            self._task.cancel()
        await self.node.close()

    async def reboot(self, silence=2.0):
        self.quiet = True
        await asyncio.sleep(silence)
        self.uptime, self.quiet = 1.0, False

    async def _send_periodically(self):
        while True:
            if not self.quiet:
                self.node.send(common.Heartbeat(type=self.type, autopilot=self.autopilot, mavlink_version=3))
                if self.uptime is not None:
                    self.node.send(common.Attitude(time_boot_ms=round(self.uptime * 1000)))
            await asyncio.sleep(SEND_INTERVAL)
            if self.uptime is not None:
                self.uptime += SEND_INTERVAL


class ConnectionHarness:
    """A connection, the peers on its network, and the events that it emitted."""

    def __init__(self, **options) -> None:
        self.network = MemoryNetwork()
        self.connection = connect(self.network.link(), **options)
        self.peers = []

    async def add_peer(self, *address, **options):
        peer = Peer(self.network, *address, **options)
        self.peers.append(peer)
        return await peer.start()

    def new_events(self, *kinds):
        """Return the events of these kinds since the last call, which drops the others."""
        return [event for event in self.events.drain() if isinstance(event, kinds)]


@asynccontextmanager
async def connection_harness(**options):
    harness = ConnectionHarness(**options)
    async with harness.connection:
        harness.events = harness.connection.events()
        try:
            yield harness
        finally:
            for peer in harness.peers:
                await peer.stop()


def run_scenario(scenario, **options):
    """Run a scenario with a connection harness in virtual time."""

    async def run():
        async with connection_harness(**options) as harness:
            await scenario(harness)

    run_virtually(run())
