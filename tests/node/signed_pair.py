"""A ground station and a vehicle over memory links, with signing keys."""

from __future__ import annotations

import asyncio

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.services.signing_setup import SigningSetupServer
from mavstack.services.signing_setup.key_change import signed_with

OLD, NEW, THIRD = (SigningKey.from_passphrase(word) for word in ("old", "new", "third"))
PX4 = common.MavAutopilot.PX4
START = 1_790_000_000.0
CHANGES = [(None, NEW), (OLD, NEW), (OLD, None)]


class SignedPair:
    """A ground station, and a vehicle that accepts keys over trusted channels."""

    def __init__(self, key=None, *, vehicle_key=..., trusted=True, timestamps=None) -> None:
        vehicle_key = key if vehicle_key is ... else vehicle_key
        self.network = MemoryNetwork()
        self.ground_link, self.vehicle_link = self.network.link(), self.network.link()
        self.ground = Node(self.ground_link, signing=key)
        self.vehicle = Node(
            self.vehicle_link,
            system=1,
            component=1,
            autopilot=PX4,
            signing=vehicle_key,
            timestamps=timestamps,
        )
        self.trusted = trusted
        policy = self.vehicle.trusted_channel_policy()
        self.server = self.vehicle.serve(
            SigningSetupServer(self.vehicle.address, key=vehicle_key, may_set=policy)
        )

    async def __aenter__(self):
        await self.ground.open()
        await self.vehicle.open()
        await asyncio.sleep(0.01)
        self.trust()
        self.remote = self.ground.component(1)
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.vehicle.close()
        await self.ground.close()

    @property
    def nodes(self):
        return self.ground, self.vehicle

    async def setup_signing(self, key, **options) -> None:
        """Install a key on the vehicle over the first channel of the ground station."""
        (name, *_) = [channel.name for channel in self.ground._host.engine.channels]
        await self.remote.setup_signing(key, channel=name, **options)

    def send_key(self, message) -> None:
        """Send a SETUP_SIGNING of the program's own to the vehicle over the first channel."""
        engine = self.ground._host.engine
        engine.key_channels.name(self.vehicle.address, engine.channels[0].name)
        self.ground.send(message)

    def trust(self) -> None:
        for channel in self.vehicle._host.engine.channels:
            channel.trusted = self.trusted

    async def reconnect(self) -> None:
        """Close the channel on both ends, and open another one of the same name."""
        names = [[channel.name for channel in node._host.engine.channels] for node in self.nodes]
        self.ground_link.channels[0].close("a test")
        await asyncio.sleep(0.01)
        assert [node._host.engine.channels for node in self.nodes] == [[], []]
        self.ground_link.connect(self.vehicle_link)
        await asyncio.sleep(0)
        assert [[channel.name for channel in node._host.engine.channels] for node in self.nodes] == names
        self.trust()


async def receive_packets(node: Node, seconds: float = 3.0):
    async with node.packets(keep_all=True) as packets:
        await asyncio.sleep(seconds)
        return packets.drain()


async def assert_both_use(pair: SignedPair, key, seconds: float = 3.0) -> None:
    """Assert that both nodes receive packets of each other, all signed with the key, and refuse none."""
    for packets in await asyncio.gather(
        receive_packets(pair.ground, seconds), receive_packets(pair.vehicle, seconds)
    ):
        assert "HEARTBEAT" in {packet.name for packet in packets}
        assert all(signed_with(packet, key, START) for packet in packets)
    for node in pair.nodes:
        for channel in node._host.engine.channels:
            assert (channel.signing is None) == (key is None)


def refusals(node: Node) -> int:
    """Return the number of packets that the channels refused."""
    kinds = ("unsigned", "forged", "replayed", "stale", "future", "too_many_streams")
    counted = [channel.signing.refusals for channel in node._host.engine.channels if channel.signing]
    return sum(getattr(each, kind) for each in counted for kind in kinds)
