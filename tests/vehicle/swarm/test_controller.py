"""The control loop beside members without vehicles, in virtual time."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from types import SimpleNamespace

import numpy as np
import pytest

from mavstack.errors import ActionInterrupted, SwarmStopped
from mavstack.sim.virtual import run_virtually
from mavstack.swarm.transitions import straight_transition
from mavstack.vehicle.swarm.controller import SwarmController, SwarmOptions

STARTS = np.array([[0.0, 0.0, 20.0], [20.0, 0.0, 20.0]])
GOALS = STARTS + np.array([0.0, 30.0, 0.0])


class PerfectMember:
    """A member that is where its last setpoint was."""

    def __init__(self, system, place):
        self.vehicle = SimpleNamespace(system=system)
        self.place, self.velocity = place, np.zeros(3)
        self.age = 0.0
        self.error = None

    @property
    def is_following(self):
        return self.error is None

    def state(self):
        return self.place, self.velocity

    def follow(self, place, velocity):
        self.place, self.velocity = place, velocity


def run(scenario):
    async def whole():
        members = [PerfectMember(index + 1, place) for index, place in enumerate(STARTS)]
        controller = SwarmController(members, SwarmOptions(), asyncio.get_running_loop().time)
        loop = asyncio.create_task(controller.run())
        try:
            await scenario(controller, members)
        finally:
            loop.cancel()
            with suppress(asyncio.CancelledError):
                await loop

    run_virtually(whole())


def test_members_arrive():
    async def scenario(controller, members):
        await controller.fly(straight_transition(STARTS, GOALS), members)
        assert np.array([each.place for each in members]) == pytest.approx(GOALS, abs=0.01)

    run(scenario)


def test_positions_that_are_late_for_a_moment_end_nothing():
    async def scenario(controller, members):
        flight = asyncio.create_task(controller.fly(straight_transition(STARTS, GOALS), members))
        await asyncio.sleep(2)
        for member in members:
            member.age = 9.0
        await asyncio.sleep(8)
        assert not flight.done()
        for member in members:
            member.age = 0.0
        await flight
        assert np.array([each.place for each in members]) == pytest.approx(GOALS, abs=0.01)

    run(scenario)


def test_a_swarm_without_members_that_follow_is_stopped():
    async def scenario(controller, members):
        flight = asyncio.create_task(controller.fly(straight_transition(STARTS, GOALS), members))
        await asyncio.sleep(2)
        for member in members:
            member.error = ActionInterrupted("following", "1/1", answer="it changed to LAND")
        with pytest.raises(SwarmStopped, match="no member follows setpoints any more"):
            await flight

    run(scenario)


def test_members_that_do_not_arrive_are_named():
    async def scenario(controller, members):
        members[1].follow = lambda place, velocity: None
        with pytest.raises(SwarmStopped, match="did not arrive") as stopped:
            await controller.fly(straight_transition(STARTS, GOALS), members)
        assert stopped.value.systems == (2,)

    run(scenario)


def test_a_cancelled_call_leaves_the_members_where_they_are():
    async def scenario(controller, members):
        flight = asyncio.create_task(controller.fly(straight_transition(STARTS, GOALS), members))
        await asyncio.sleep(2)
        flight.cancel()
        with suppress(asyncio.CancelledError):
            await flight
        await asyncio.sleep(1)
        before = members[0].place
        await asyncio.sleep(10)
        assert members[0].place == pytest.approx(before)
        assert before[1] < 29.0

    run(scenario)
