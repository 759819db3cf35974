"""Simulated vehicles over simulated SiK radios: pacing that is learned from RADIO_STATUS."""

from __future__ import annotations

import asyncio
from typing import NamedTuple

import pytest

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.links.radio import BANDWIDTH, Radio, sik_radio
from mavstack.node import Node
from mavstack.sim import Simulation, run_virtually
from mavstack.sim.scenarios import arm, run_until
from tests.sim.running import reduce_telemetry, running

LOG_SIZE = 40_000
STATUSES = 10


class Outcome(NamedTuple):
    """A log that was downloaded over a radio."""

    seconds: float
    overflowed: int
    statuses: list[common.RadioStatus]


def download_log() -> Outcome:
    simulation = Simulation()
    vehicle = simulation.add("rover")
    arm(simulation, vehicle)
    run_until(simulation, lambda: vehicle.storage.logs.logs()[0].size > LOG_SIZE)
    vehicle.autopilot.disarm("enough")
    reduce_telemetry(vehicle)
    statuses: list[common.RadioStatus] = []

    async def work() -> Outcome:
        network = MemoryNetwork()
        async with (
            running(simulation, sik_radio(network.link())) as advancing,
            Node(network.link()) as ground,
        ):
            ground.add_listener(common.RadioStatus, statuses.append)
            peer = await ground.wait_for_autopilot(timeout=30)
            await asyncio.sleep(STATUSES)
            began, (channel,) = ground.now(), advancing.link.channels
            before = channel.stats[0].overflowed
            data = await peer.logs.download(1)
            assert len(data) > LOG_SIZE
            return Outcome(ground.now() - began, channel.stats[0].overflowed - before, statuses)

    return run_virtually(work())


@pytest.mark.flight
def test_a_log_slows_down_to_the_radio():
    outcome = download_log()
    assert LOG_SIZE / BANDWIDTH < outcome.seconds < 4 * LOG_SIZE / BANDWIDTH
    assert len(outcome.statuses) >= STATUSES
    assert all(0 <= status.txbuf <= 100 for status in outcome.statuses)
    assert outcome.overflowed < 10


@pytest.mark.flight
def test_without_radio_status_a_log_overflows_the_radio(monkeypatch):
    monkeypatch.setattr(Radio, "reports", lambda *_: [])
    outcome = download_log()
    assert outcome.overflowed > 50
