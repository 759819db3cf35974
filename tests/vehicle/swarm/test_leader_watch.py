"""A flight behind a leader ends when the leader is lost, beside a leader without a link."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace

import pytest

from mavstack.dialects import common
from mavstack.errors import ContactLost, InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.sim.virtual import run_virtually
from mavstack.swarm.leader import LeaderFrame
from mavstack.vehicle.swarm.leader_watch import fly_with_leader
from mavstack.vehicle.swarm.swarm import Swarm


def test_a_lost_leader_cancels_the_flight():
    async def scenario():
        now = asyncio.get_running_loop().time
        message = common.GlobalPositionInt(lat=473977000, lon=85456000, alt=500000)
        position = SimpleNamespace(message=message), now()
        vehicle = SimpleNamespace(connection=SimpleNamespace(now=now), address="9/1")
        leader = SimpleNamespace(vehicle=vehicle, read_position=lambda: position)
        ended = []

        async def flight():
            try:
                await asyncio.sleep(60)
            finally:
                ended.append(now())

        frame = LocalFrame(47.3977, 8.5456, 488.0)
        begun = now()
        with pytest.raises(ContactLost, match="no position arrives"):
            await fly_with_leader(flight(), leader, LeaderFrame(0.0, 45.0), frame, 2.5)
        assert 2.5 < ended[0] - begun < 2.8

    run_virtually(scenario())


@pytest.mark.parametrize("duration", [0.0, 12.0])
def test_only_a_swarm_on_its_way_can_pause(duration):
    """A pause before the first course, while a call checks its plan, would be lost when the course begins."""
    swarm = Swarm([SimpleNamespace()])
    controller = SimpleNamespace(progress=(1.0, duration), pace=SimpleNamespace(paused=False))
    object.__setattr__(swarm, "_controller", controller)
    if duration:
        swarm.pause()
    else:
        with pytest.raises(InvalidArgumentError, match="on no way"):
            swarm.pause()
    assert controller.pace.paused is bool(duration)
