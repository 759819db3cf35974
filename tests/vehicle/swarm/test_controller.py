"""The control loop beside members without vehicles, in virtual time."""

from __future__ import annotations

import asyncio
from contextlib import suppress

import numpy as np
import pytest

from mavstack.errors import ActionInterrupted, SwarmStopped
from mavstack.swarm.courses import Following
from mavstack.swarm.formations import Formation
from mavstack.swarm.leader import LeaderFrame
from mavstack.swarm.separation import Margins
from mavstack.swarm.transitions import straight_transition
from mavstack.vehicle.swarm.controller import SwarmOptions
from tests.vehicle.swarm.perfect_fleet import GOALS, STARTS, PerfectMember, Stranger, run


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


def test_a_course_waits_while_no_position_arrives():
    async def scenario(controller, members):
        course = straight_transition(STARTS, GOALS)
        flight = asyncio.create_task(controller.fly(course, members))
        await asyncio.sleep(3)
        for member in members:
            member.age = 2.0
        await asyncio.sleep(0.2)
        before = members[0].place
        await asyncio.sleep(course.duration)
        assert members[0].place == pytest.approx(before, abs=0.01)
        assert not any(member.velocity.any() for member in members)
        for member in members:
            member.age = 0.0
        await asyncio.sleep(0.1)
        assert members[0].place[1] == pytest.approx(before[1], abs=1.0)  # it goes on where it was
        await flight

    run(scenario)


def test_members_pause_on_their_ways_and_fly_on():
    async def scenario(controller, members):
        course = straight_transition(STARTS, GOALS)
        flight = asyncio.create_task(controller.fly(course, members))
        await asyncio.sleep(3)
        controller.pace.paused = True
        await asyncio.sleep(4)
        before, elapsed = members[0].place, controller.progress[0]
        await asyncio.sleep(30)
        assert members[0].place == pytest.approx(before, abs=1e-6)
        assert before == pytest.approx(course.state(elapsed)[0][0], abs=0.1)
        assert not flight.done()
        assert not any(member.velocity.any() for member in members)
        controller.pace.paused = False
        await flight
        assert np.array([each.place for each in members]) == pytest.approx(GOALS, abs=0.01)

    run(scenario)


def test_a_pause_at_the_end_of_a_course_holds_back_the_next_one():
    async def scenario(controller, members):
        course = straight_transition(STARTS, GOALS)
        flight = asyncio.create_task(controller.fly(course, members))
        await asyncio.sleep(course.duration - 0.5)
        controller.pace.paused = True
        await asyncio.sleep(60)
        assert not flight.done()
        assert np.array([each.place for each in members]) == pytest.approx(GOALS, abs=0.01)
        controller.pace.paused = False
        await flight

    run(scenario)


def test_a_paused_swarm_is_stopped():
    async def scenario(controller, members):
        flight = asyncio.create_task(controller.fly(straight_transition(STARTS, GOALS), members))
        await asyncio.sleep(2)
        controller.pace.paused = True
        await asyncio.sleep(4)
        controller.stop("a test")
        with pytest.raises(SwarmStopped, match="a test"):
            await flight
        assert not controller.pace.paused, "the next call flies"

    run(scenario)


def test_no_delay_is_learned_from_the_time_in_which_a_program_was_held_up():
    async def scenario(controller, members):
        steps, learn = [], controller.delays.learn
        controller.delays.learn = lambda *each: (steps.append(each[-1]), learn(*each))
        leader = LeaderFrame(0.0, 45.0)
        leader.update(STARTS[0], np.zeros(3), controller._fleet.now())
        course = Following(leader, STARTS - STARTS[0], controller._fleet.now())
        flight = asyncio.create_task(controller.fly(course, members, until=20.0))
        await asyncio.sleep(3)
        now = controller._fleet.now
        controller._fleet.now = lambda: now() + 7.0
        await flight
        assert controller.progress[0] == pytest.approx(20.0, abs=0.2), (
            "the course keeps the time of the clock"
        )
        assert max(steps) < 0.5

    run(scenario)


def test_a_program_that_was_held_up_continues_where_it_was():
    async def scenario(controller, members):
        flight = asyncio.create_task(controller.fly(straight_transition(STARTS, GOALS), members))
        await asyncio.sleep(3)
        before, now = members[0].place, controller._fleet.now
        controller._fleet.now = lambda: now() + 7.0  # as a process that the system did not run sees it
        await asyncio.sleep(0.1)
        assert members[0].place[1] - before[1] < 3.0
        await flight

    run(scenario)


def test_a_swarm_whose_positions_do_not_return_is_stopped():
    async def scenario(controller, members):
        flight = asyncio.create_task(controller.fly(straight_transition(STARTS, GOALS), members))
        await asyncio.sleep(2)
        for member in members:
            member.age = 9.0
        with pytest.raises(SwarmStopped, match="no positions of the members arrive"):
            await flight
        for member in members:
            member.age = 0.0
        before = members[0].place
        await asyncio.sleep(30)
        assert members[0].place == pytest.approx(before), "the course that has failed is not continued"

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


def test_a_call_ends_with_the_control_loop():
    async def scenario(controller, members):
        flight = asyncio.create_task(controller.fly(straight_transition(STARTS, GOALS), members))
        await asyncio.sleep(2)
        controller._fleet.read = None
        with pytest.raises(SwarmStopped, match="the control loop of the swarm has ended"):
            await flight

    with pytest.raises(TypeError, match="not callable"):
        run(scenario)


def test_members_that_do_not_arrive_are_named():
    async def scenario(controller, members):
        members[1].follow = lambda place, velocity: None
        with pytest.raises(SwarmStopped, match="did not arrive") as stopped:
            await controller.fly(straight_transition(STARTS, GOALS), members)
        assert stopped.value.systems == (2,)

    run(scenario)


@pytest.mark.parametrize(("close_gaps", "slots"), [(True, [0, 1, 2]), (False, [0, 1, 3])])
@pytest.mark.parametrize("leaders", [0, 1])
def test_the_slot_of_a_lost_member_is_closed_up_or_stays_empty(close_gaps, slots, leaders):
    shape = Formation("column", spacing=10.0)

    async def scenario(controller, members):
        members[2].error = ActionInterrupted("following", "3/1", answer="it changed to LAND")
        await asyncio.sleep(0.2)
        found = controller.offsets(shape, controller.active, leaders=leaders)
        assert found == pytest.approx(shape.offsets(leaders + 4)[leaders:][slots])
        members[0].error = members[2].error
        await asyncio.sleep(0.2)
        found = controller.offsets(shape, controller.active, leaders=leaders)
        rest = [0, 1] if close_gaps else [0, 3]
        assert found == pytest.approx(shape.offsets(leaders + 4)[leaders:][rest]), "the next one leads"

    starts = np.arange(4.0)[:, None] * (20.0, 0.0, 0.0) + (0.0, 0.0, 20.0)
    run(scenario, SwarmOptions(Margins(latency=0.0), close_gaps=close_gaps), starts=starts)


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


def fly_past_a_stranger(controller, members):
    return controller.fly(straight_transition(STARTS, GOALS), members, others=[Stranger()])


def test_members_avoid_a_vehicle_that_is_not_a_member():
    async def scenario(controller, members):
        await fly_past_a_stranger(controller, members)
        assert np.array([each.place for each in members]) == pytest.approx(GOALS, abs=1.0)
        assert controller.guard.smallest_separation > 3.0

    run(scenario)


def test_members_that_were_stopped_avoid_a_vehicle_that_is_not_a_member():
    async def scenario(controller, members):
        flight = asyncio.create_task(
            controller.fly(straight_transition(STARTS, GOALS), members, others=[Stranger()])
        )
        await asyncio.sleep(0.5)
        controller.stop("a test")
        with pytest.raises(SwarmStopped, match="a test"):
            await flight
        await asyncio.sleep(20.0)
        assert 3.0 < controller.guard.smallest_separation < 6.0, "it came near"

    run(scenario)


def test_the_guard_counts_a_vehicle_that_is_not_a_member():
    async def scenario(controller, members):
        with pytest.raises(SwarmStopped, match="separation of vehicle 1 and vehicle 9") as stopped:
            await fly_past_a_stranger(controller, members)
        assert stopped.value.systems == (1, 9)

    run(scenario, SwarmOptions(avoid=False))


def test_a_vehicle_without_a_position_is_not_avoided():
    async def scenario(controller, members):
        stranger = Stranger()
        stranger.place = stranger.velocity = np.full(3, np.nan)
        await controller.fly(straight_transition(STARTS, GOALS), members, others=[stranger])
        assert np.array([each.place for each in members]) == pytest.approx(GOALS, abs=0.01)

    run(scenario)


def test_members_fly_their_course_if_the_position_of_one_is_not_known():
    async def scenario(controller, members):
        unknown = np.full(3, np.nan)
        members[0].state = lambda: (unknown, unknown)
        flight = asyncio.create_task(controller.fly(straight_transition(STARTS, GOALS), members))
        await asyncio.sleep(3)
        assert np.isfinite(np.array([each.place for each in members])).all()
        assert members[1].place[1] > STARTS[1][1] + 1.0
        flight.cancel()

    run(scenario)


class Leader(Stranger):
    """A leader that flies north, and turns back through its followers."""

    def __init__(self, frame, now):
        super().__init__()
        self.place, self.velocity = np.array([20.0, 0.0, 20.0]), np.array([3.0, 0.0, 0.0])
        self.frame, self.now, self.steps = frame, now, 0

    def state(self):
        self.steps += 1
        if self.steps == 100:
            self.velocity = np.array([-8.0, 0.0, 0.0])  # faster than its followers
        found = super().state()
        self.frame.update(*found, self.now())
        return found


class LimitedMember(PerfectMember):
    """A member that flies to its setpoint at 5 m/s at most."""

    def follow(self, place, velocity):
        before = self.place
        way = 0.1 * velocity if np.isnan(place).any() else place - before
        self.place = before + way * min(1.0, 0.5 / max(float(np.linalg.norm(way)), 1e-9))
        self.velocity = 10.0 * (self.place - before)


#: The places of two followers behind their leader, and the same exchanged: their ways cross.
COLUMN = np.array([[-10.0, 0.0, 0.0], [-20.0, 0.0, 0.0]])
FOLLOWERS = {"in their order": COLUMN, "crossing": COLUMN[::-1]}


async def follow_back(controller, members, offsets):
    """Let members follow a leader that turns back, for half a minute."""
    frame, now = LeaderFrame(0.0, 1.0), controller._fleet.now  # a wide formation turns slowly
    leader = Leader(frame, now)
    for member, place in zip(members, leader.place + COLUMN, strict=True):
        member.place = place
    frame.update(leader.place, leader.velocity, now())
    course = Following(frame, offsets, now())
    await controller.fly(course, members, until=30.0, others=[leader])
    assert leader.place[0] < -10.0, "it flew through them"


@pytest.mark.parametrize("order", FOLLOWERS)
def test_followers_avoid_a_leader_that_turns_back_and_each_other(order):
    async def scenario(controller, members):
        await follow_back(controller, members, FOLLOWERS[order])
        assert controller.guard.smallest_separation >= 2.0

    run(scenario, kind=LimitedMember)


@pytest.mark.parametrize("order", FOLLOWERS)
def test_without_avoidance_followers_come_too_near(order):
    async def scenario(controller, members):
        with pytest.raises(SwarmStopped, match="separation of vehicle"):
            await follow_back(controller, members, FOLLOWERS[order])
        assert controller.guard.smallest_separation < 2.0

    run(scenario, SwarmOptions(Margins(latency=0.0), avoid=False), LimitedMember)
