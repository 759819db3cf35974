"""A member of a swarm beside a vehicle whose answers the test makes."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ContactLost
from mavstack.services import Address
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle.firmware import Px4
from mavstack.vehicle.swarm.member import Member


class Session:
    """A session of setpoints whose checks raise the errors of a list, one for each call."""

    def __init__(self, errors, entering=None):
        self.errors, self.entering = list(errors), entering
        self.streams, self.ended_by = True, None

    async def __aenter__(self):
        if self.entering is not None:
            raise self.entering

    async def __aexit__(self, kind, error, trace):
        assert kind is (None if error is None else type(error))
        self.streams, self.ended_by = False, error

    def check(self):
        error = self.errors.pop(0) if self.errors else None
        if error is not None:
            raise error

    def stop_stream(self):
        self.streams = False


class Vehicle:
    """A vehicle that only makes sessions."""

    def __init__(self, *sessions):
        self.system, self.address = 1, Address(1, 1)
        self.telemetry = SimpleNamespace(firmware=Px4, reader=lambda _kind: lambda: None)
        self.sessions, self.waited = list(sessions), []

    def guided(self, rate):
        return self.sessions.pop(0)

    async def wait_for_message(self, kind, *, timeout):
        self.waited.append(kind)


def member_of(*sessions):
    vehicle = Vehicle(*sessions)
    return Member(vehicle), vehicle


def lost():
    return ContactLost("following setpoints with", "1/1", answer="it fell silent")


def test_a_member_whose_heartbeats_were_late_follows_again():
    session = Session([None, lost(), lost(), None])
    member, _ = member_of(session)

    async def scenario():
        await member.enter()
        for _ in range(4):
            member.check()
            assert member.is_following
        assert not session.errors

    run_virtually(scenario())


def test_a_member_that_left_its_mode_is_not_called_back():
    session = Session([None, ActionInterrupted("following", "1/1", answer="it changed to LAND"), None])
    member, _ = member_of(session)

    async def scenario():
        await member.enter()
        for _ in range(4):
            member.check()
        assert not member.is_following
        assert session.errors == [None], "it was checked again"

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


def test_the_stream_of_the_session_ends_when_the_fleet_sends():
    session = Session([])
    member, _ = member_of(session)
    member.take_over()
    assert session.streams

    async def scenario():
        await member.enter()
        member.take_over()
        assert not session.streams

    run_virtually(scenario())


@pytest.mark.parametrize(
    ("own", "of_the_swarm", "expected"),
    [
        (None, None, None),
        (None, ValueError(), ValueError),
        (ActionInterrupted, ValueError(), ActionInterrupted),
    ],
)
def test_a_session_ends_by_the_error_of_its_member_or_else_of_the_swarm(own, of_the_swarm, expected):
    session = Session([])
    member, _ = member_of(session)

    async def scenario():
        await member.enter()
        if own is not None:
            member.error = own("guided flight", "1/1")
        await member.leave(of_the_swarm)

    run_virtually(scenario())
    assert (session.ended_by and type(session.ended_by)) is expected
