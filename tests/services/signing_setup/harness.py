"""A vehicle and a ground station with signed channels, joined by a simulated link."""

from __future__ import annotations

from mavstack.node.key_change import trusted_channels
from mavstack.services.heartbeat import HeartbeatSender
from mavstack.services.signing_setup import KeySettled, SigningSetupClient, SigningSetupServer
from mavstack.services.timesync import TimesyncServer
from tests.services.network import GROUND, VEHICLE, Network


class SigningHarness:
    """A vehicle and a ground station that both begin with `key`.

    `policy` is the vehicle's rule for accepting keys; None accepts them over its trusted channels.
    """

    def __init__(self, seed=0, *, key=None, impairment=None, policy=None, trusted=True, answers=True):
        self.network = Network(seed, keep_packets=True)
        self.key, self.policy, self.trusted, self.answers = key, policy, trusted, answers
        self.ground_key = key
        self.settled_before = 0
        self.vehicle = self.network.node(VEHICLE, self.setup_vehicle)
        self.ground = self.network.node(GROUND)
        self.ground.engine.add(HeartbeatSender(GROUND))
        self.client = self.ground.engine.add(SigningSetupClient(GROUND, VEHICLE))
        self.pipes = self.network.connect(self.ground, self.vehicle, impairment)
        self.ground.ports[0].channel.name = "wire to the vehicle"
        self.sign(self.ground, key)
        self.sign(self.vehicle, key)

    def setup_vehicle(self, engine):
        engine.add(HeartbeatSender(VEHICLE, 2, 3))
        if self.answers:
            engine.add(TimesyncServer(VEHICLE))
        policy = self.policy or trusted_channels(engine)
        self.server = engine.add(SigningSetupServer(VEHICLE, key=self.stored(), may_set=policy))

    def stored(self):
        """The key that the vehicle's program stored: that of the last completed change."""
        for event in reversed((getattr(self, "vehicle", None) and self.vehicle.events_of(KeySettled)) or []):
            if event.changed:
                return event.key
        return self.key

    def sign(self, node, key):
        for port in node.ports:
            port.channel.trusted = self.trusted
            port.channel.signing = key.signing(unsigned_ids=(109,)) if key else None

    def restart_vehicle(self):
        self.vehicle.restart()
        self.sign(self.vehicle, self.stored())

    def install(self, key, timeout=40.0):
        (port, *_) = self.ground.ports
        self.ground.engine.key_channels.name(VEHICLE, port.channel.name)
        operation = self.client.install(key, self.network.now, timeout=timeout)
        self.ground.engine.touch(self.client)
        return operation

    def run(self, operation):
        assert self.network.run(lambda: operation.done, timeout=120.0)
        return operation

    def assert_heartbeats_arrive(self):
        """Both receive the other's heartbeats through their signing."""
        self.ground.received.clear()
        self.vehicle.received.clear()
        self.network.run(timeout=5.0)
        assert [packet for packet in self.ground.received if packet.name == "HEARTBEAT"]
        assert [packet for packet in self.vehicle.received if packet.name == "HEARTBEAT"]

    @property
    def signed(self):
        """Return whether the last packets of (ground, vehicle) are signed."""
        return self.vehicle.received[-1].signed, self.ground.received[-1].signed
