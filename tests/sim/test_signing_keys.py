"""SETUP_SIGNING on simulated vehicles, end to end."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from time import time

import pytest

from mavstack.dialects import common
from mavstack.errors import RemoteDenied, RemoteTimeout
from mavstack.links import Impairment, MemoryNetwork, impair
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.services import BROADCAST
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from tests.sim.running import reduce_telemetry

KEY, OTHER = SigningKey.from_passphrase("fleet"), SigningKey.from_passphrase("another")
FIRMWARES = pytest.mark.parametrize("firmware", list(Firmware))


class Field:
    """A vehicle on two links, and ground stations on them."""

    def __init__(self, firmware: Firmware, *, loss: float = 0.0) -> None:
        self.simulation = Simulation(seed=5, start=float(int(time())))
        self.vehicle = self.simulation.add(VehicleType.COPTER, firmware)
        reduce_telemetry(self.vehicle)
        self.events: list[str] = []
        self.vehicle.listeners.append(self._event)
        self.network = MemoryNetwork()
        self.loss = loss

    def _event(self, vehicle, kind: str, text: str) -> None:
        self.events += [text] if kind == "signing" else []

    @asynccontextmanager
    async def ground(self, key: SigningKey | None = None, name: str = "first"):
        link = impair(self.network.link(f"memory://{name}"), Impairment(loss=self.loss, seed=3))
        async with Node(link, signing=key) as node:
            yield node

    async def setup_signing(self, ground: Node, key: SigningKey | None, timeout=None) -> None:
        peer = await ground.wait_for_autopilot(timeout=10)
        await peer.setup_signing(key, channel=ground.links[0].channels[0], timeout=timeout)

    async def answers(self, key: SigningKey | None, name: str = "first") -> bool:
        """Return whether the vehicle answers a ground station with that key."""
        async with self.ground(key, name) as ground:
            try:
                await (await ground.wait_for_autopilot(timeout=5)).ping(timeout=5)
            except RemoteTimeout:
                return False
        return True


def fly(field: Field, work, *, keys: dict[str, str] | None = None) -> None:
    """Run the work beside the vehicle; `keys` are key files of its links by the link's name."""

    async def run() -> None:
        async with Runner(field.simulation) as runner:
            for name in ("first", "second"):
                key = f"?signing_key={keys[name]}" if keys and name in keys else ""
                await runner.connect(field.network.link(f"memory://{name}{key}"), [field.vehicle])
            runner.start()
            await work(field)

    run_virtually(run())
    field.simulation.close()


@FIRMWARES
def test_a_key_is_used_from_then_on_over_all_links_and_reboots(firmware):
    async def work(field):
        assert await field.answers(None)
        async with field.ground() as ground:
            await field.setup_signing(ground, KEY)
            await (await ground.wait_for_autopilot()).ping(timeout=5)
        for _ in range(2):
            for name in ("first", "second"):
                assert await field.answers(KEY, name)
                assert not await field.answers(None, name)
                assert not await field.answers(OTHER, name)
            field.vehicle.reboot()
            await asyncio.sleep(5)
        assert field.events == ["signing key set"]

    fly(Field(firmware), work)


def test_a_key_is_changed_and_removed_by_its_holder_only():
    async def work(field):
        async with field.ground() as ground:
            await field.setup_signing(ground, KEY)
        async with field.ground() as stranger:
            with pytest.raises((RemoteTimeout, RemoteDenied)):
                await field.setup_signing(stranger, OTHER, timeout=3)
        async with field.ground(KEY) as ground:
            await field.setup_signing(ground, OTHER)
        assert await field.answers(OTHER, "second")
        assert not await field.answers(KEY)
        async with field.ground(OTHER) as ground:
            await field.setup_signing(ground, None)
        assert await field.answers(None)
        assert await field.answers(None, "second")
        assert field.events == ["signing key set", "signing key set", "signing turned off"]

    fly(Field(Firmware.ARDUPILOT), work)


@FIRMWARES
def test_a_key_is_set_over_a_link_that_loses_packets(firmware):
    async def work(field):
        async with field.ground() as ground:
            peer = await ground.wait_for_autopilot(timeout=30)
            for key in (KEY, OTHER, None, KEY):
                await peer.setup_signing(key, channel=ground.links[0].channels[0])
                await peer.get_message_interval(common.Heartbeat)
        assert field.vehicle.signing_keys.key == KEY

    fly(Field(firmware, loss=0.3), work)


@FIRMWARES
def test_an_armed_vehicle_refuses_a_key(firmware):
    async def work(field):
        async with field.ground() as ground:
            await ground.wait_for_autopilot(timeout=10)
            field.vehicle.autopilot.arm(force=True)
            texts = ground.stream(common.Statustext, keep_all=True)
            with pytest.raises((RemoteDenied, RemoteTimeout)):
                await field.setup_signing(ground, KEY, timeout=3)
            assert "Signing setup refused: the vehicle is armed" in {each.text for each in texts.drain()}
        assert field.vehicle.signing_keys.key is None

    fly(Field(firmware), work)


def test_a_key_for_all_systems_counts_whatever_its_timestamp():
    async def work(field):
        async with field.ground() as ground:
            await ground.wait_for_autopilot(timeout=10)
            engine = ground._host.engine
            engine.key_channels.name(BROADCAST, engine.channels[0].name)
            for key in (KEY, OTHER):
                ground.send(common.SetupSigning(secret_key=key.secret_bytes(), initial_timestamp=5))
            await asyncio.sleep(1)
        assert field.vehicle.signing_keys.key == KEY  # the second one came unsigned

    fly(Field(Firmware.PX4), work)


def test_a_key_that_was_set_up_replaces_those_of_the_links(tmp_path):
    KEY.save(tmp_path / "link.key")

    async def work(field):
        assert await field.answers(KEY)
        assert not await field.answers(None)
        assert await field.answers(None, "second")
        async with field.ground(KEY) as ground:
            await field.setup_signing(ground, None)
        assert await field.answers(None)
        async with field.ground(None, "second") as ground:
            await field.setup_signing(ground, OTHER)
        assert await field.answers(OTHER)

    fly(Field(Firmware.ARDUPILOT), work, keys={"first": str(tmp_path / "link.key")})


@pytest.mark.parametrize("key", [None, KEY], ids=["unsigned link", "signed link"])
def test_an_unsigned_radio_status_counts_only_where_the_link_does_not_sign(key):
    async def work(field):
        if key is not None:
            async with field.ground() as ground:
                await field.setup_signing(ground, key)
        async with Node(field.network.link("memory://second"), system=51, component=68) as radio:
            await asyncio.sleep(0.5)
            port = field.vehicle.ports[-1]
            assert port.state.verifies is (key is not None)
            radio.send(common.RadioStatus(txbuf=50))
            await asyncio.sleep(0.5)
            assert port.state.pacer.learned is (key is None)

    fly(Field(Firmware.ARDUPILOT), work)
