"""A member of a swarm beside a vehicle whose answers the test makes."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ContactLost
from mavstack.geodesy import LocalFrame
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle.swarm.member import Member

PLACE, MOTION = np.array((10.0, 0.0, 20.0)), np.array((1.0, 0.0, 0.0))


class Session:
    """A session of setpoints that raises the errors of a list, one for each call."""

    def __init__(self, errors, entering=None):
        self.errors, self.entering = list(errors), entering
        self.setpoints = []

    async def __aenter__(self):
        if self.entering is not None:
            raise self.entering

    async def __aexit__(self, *_):
        pass

    def set(self, setpoint):
        error = self.errors.pop(0) if self.errors else None
        if error is not None:
            raise error
        self.setpoints.append(setpoint)


class Vehicle:
    """A vehicle on the ground at its home."""

    def __init__(self, *sessions):
        self.system, self.sessions, self.waited = 1, list(sessions), []
        self.message = common.GlobalPositionInt(lat=473977000, lon=85456000, alt=488000)
        self.connection = SimpleNamespace()

    def guided(self, rate):
        return self.sessions.pop(0)

    def latest(self, _kind):
        return self.message

    def age(self, _kind):
        return 0.1

    async def wait_for_message(self, kind, *, timeout):
        self.waited.append(kind)


def member_of(*sessions):
    vehicle = Vehicle(*sessions)
    member = Member(vehicle, LocalFrame(47.3977, 8.5456, 488.0))
    return member, vehicle


def lost():
    return ContactLost("following setpoints with", "1/1", answer="it fell silent")


def test_a_member_whose_heartbeats_were_late_follows_again():
    session = Session([None, lost(), lost(), None])
    member, _ = member_of(session)

    async def scenario():
        await member.enter()
        for _ in range(4):
            member.follow(PLACE, MOTION)
        assert member.is_following
        assert len(session.setpoints) == 2

    run_virtually(scenario())


def test_a_member_that_left_its_mode_is_not_called_back():
    session = Session([None, ActionInterrupted("following", "1/1", answer="it changed to LAND")])
    member, _ = member_of(session)

    async def scenario():
        await member.enter()
        for _ in range(4):
            member.follow(PLACE, MOTION)
        assert not member.is_following
        assert len(session.setpoints) == 1

    run_virtually(scenario())


def test_a_member_enters_again_if_a_heartbeat_arrives():
    member, vehicle = member_of(Session([], lost()), Session([]))

    async def scenario():
        await member.enter()
        assert vehicle.waited == [common.Heartbeat]
        assert member.is_following

    run_virtually(scenario())


def test_a_vehicle_that_stays_lost_does_not_enter():
    member, _ = member_of(Session([], lost()), Session([], lost()))

    async def scenario():
        with pytest.raises(ContactLost):
            await member.enter()
        assert not member.is_following

    run_virtually(scenario())


def test_heights_of_setpoints_are_above_the_home_of_the_vehicle():
    session = Session([])
    member, vehicle = member_of(session)
    vehicle.message = common.GlobalPositionInt(lat=473977000, lon=85456000, alt=498000, relative_alt=2000)

    async def scenario():
        await member.enter()
        member.follow(PLACE, MOTION)
        assert session.setpoints[0].altitude == pytest.approx(12.0)  # 508 m above the sea, home at 496 m

    run_virtually(scenario())


@pytest.mark.parametrize(("height", "down"), [(20.0, 2.0), (5.0, 1.0), (2.0, 0.0), (0.0, 0.0)])
def test_no_velocity_leads_to_the_ground_if_the_program_ends(height, down):
    session = Session([])
    member, vehicle = member_of(session)
    vehicle.message = common.GlobalPositionInt(relative_alt=round(1e3 * height))

    async def scenario():
        await member.enter()
        member.follow(np.full(3, np.nan), np.array((1.0, 0.0, -2.0)))
        assert session.setpoints[0].velocity == pytest.approx((1.0, 0.0, down))

    run_virtually(scenario())
