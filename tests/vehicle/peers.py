"""Scripted components on a memory network: they say who they are, and how long they have been up."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect

TYPE, AUTOPILOT = common.MavType, common.MavAutopilot
#: How often a peer says something, in seconds.
EVERY = 0.5


class Peer:
    """A component that sends HEARTBEAT and, if it has an `uptime`, what tells it."""

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
        self._task = asyncio.create_task(self._speak())
        return self

    async def stop(self):
        """Go away; its links are closed."""
        if self._task is not None:
            self._task.cancel()
        await self.node.close()

    async def reboot(self, silence=2.0):
        self.quiet = True
        await asyncio.sleep(silence)
        self.uptime, self.quiet = 1.0, False

    async def _speak(self):
        while True:
            if not self.quiet:
                self.node.send(common.Heartbeat(type=self.type, autopilot=self.autopilot, mavlink_version=3))
                if self.uptime is not None:
                    self.node.send(common.Attitude(time_boot_ms=round(self.uptime * 1000)))
            await asyncio.sleep(EVERY)
            if self.uptime is not None:
                self.uptime += EVERY


class Stage:
    """A connection, the peers that it meets, and what it told since it was asked last."""

    def __init__(self, **options) -> None:
        self.network = MemoryNetwork()
        self.node = connect(self.network.link(), **options)
        self.peers = []

    async def enter(self, *place, **options):
        peer = Peer(self.network, *place, **options)
        self.peers.append(peer)
        return await peer.start()

    def told(self, *kinds):
        return [event for event in self.events.drain() if isinstance(event, kinds)]


@asynccontextmanager
async def stage(**options):
    made = Stage(**options)
    async with made.node:
        made.events = made.node.events()
        try:
            yield made
        finally:
            for peer in made.peers:
                await peer.stop()


def play(scenario, **options):
    """Run a scenario on a stage in virtual time."""

    async def whole():
        async with stage(**options) as made:
            await scenario(made)

    run_virtually(whole())
