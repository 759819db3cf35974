"""A fleet reads positions and sends setpoints, beside vehicles whose messages the test makes."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from mavstack.dialects import common
from mavstack.geodesy import LocalFrame
from mavstack.services import Address
from mavstack.vehicle.swarm import fleet as fleet_module
from mavstack.vehicle.swarm.fleet import Fleet, Setpoints, read_states

FRAME = LocalFrame(47.3977, 8.5456, 488.0)
NOW = 100.0


class Host:
    """The host of a node, which keeps the messages of a step."""

    def __init__(self):
        self.address, self.time, self.sent = Address(255, 190), NOW, []

    def now(self):
        return self.time

    def serve(self, service):
        pass

    def remove(self, service):
        pass

    def wake(self, service):
        self.sent = [each.message for each in service.messages_to_send(self.time)]


class Member:
    """A member with a latest position."""

    def __init__(self, system, *, follows_acceleration=False, **fields):
        self.follows_acceleration = follows_acceleration
        self.system, self.address, self.is_following, self.taken = system, Address(system, 1), True, 0
        message = common.GlobalPositionInt(**fields) if fields else None
        found = None if message is None else (SimpleNamespace(message=message), NOW - 0.1)
        self.read_position = lambda: found
        self.vehicle = SimpleNamespace(connection=None)
        self.checks = 0

    def take_over(self):
        self.taken += 1

    def check(self):
        self.checks += 1


HERE = {"lat": 473977000, "lon": 85456000, "alt": 508000, "relative_alt": 20000}


@pytest.fixture
def host(monkeypatch):
    made = Host()
    monkeypatch.setattr(fleet_module, "host_of", lambda _node: made)
    return made


def setpoints(*rows):
    """Setpoints of rows of a place, a velocity and an acceleration."""
    return Setpoints(*np.array(rows, float).reshape(-1, 3, 3).transpose(1, 0, 2))


def send(host, place, velocity, acceleration=(0.0, 0.0, 0.0), **fields):
    member = Member(1, **(HERE | fields))
    fleet = Fleet([member], FRAME)
    fleet.send([member], setpoints((place, velocity, acceleration)), fleet.read().heights)
    (message,) = host.sent
    return message


def test_positions_are_extrapolated_and_unknown_ones_are_nan(host):
    members = [Member(1, **HERE, vx=500, vz=-200), Member(2)]
    found = read_states(members, FRAME, NOW)
    assert found.positions[0] == pytest.approx([0.5, 0.0, 20.2], abs=1e-3)
    assert found.velocities[0] == pytest.approx([5.0, 0.0, 2.0])
    assert found.heights[0] == pytest.approx(20.0)
    assert np.isnan(found.positions[1]).all()
    assert found.ages.tolist() == pytest.approx([0.1, math.inf])
    late = read_states(members, FRAME, NOW + 60.0)
    assert late.positions[0][0] == pytest.approx(5.0, abs=1e-3), "extrapolated for a second at most"


def test_a_position_that_cannot_be_decoded_is_unknown():
    member = Member(1, **HERE)
    packet = SimpleNamespace(message=None)
    member.read_position = lambda: (packet, NOW)
    found = read_states([member], FRAME, NOW)
    assert np.isnan(found.positions).all()
    assert math.isinf(found.ages[0])


def test_heights_of_setpoints_are_above_the_sea(host):
    message = send(host, (10.0, 0.0, 20.0), (1.0, 0.0, 0.5), alt=498000, relative_alt=2000)
    assert message.alt == pytest.approx(508.0)
    latitude, longitude, _ = FRAME.to_global(10.0, 0.0, -20.0)
    assert (message.lat_int, message.lon_int) == (round(latitude * 1e7), round(longitude * 1e7))
    assert (message.vx, message.vy, message.vz) == (1.0, 0.0, -0.5)
    assert message.coordinate_frame == common.MavFrame.GLOBAL_INT
    assert int(message.type_mask) == 0b1101_1100_0000
    assert (message.target_system, message.target_component) == (1, 1)


def test_a_firmware_that_adds_accelerations_gets_them(host):
    acceleration = (0.5, -1.0, 0.25)
    message = send(host, (0.0, 0.0, 20.0), (1.0, 0.0, 0.0), acceleration, follows_acceleration=True)
    assert (message.afx, message.afy, message.afz) == (0.5, -1.0, -0.25)
    assert int(message.type_mask) == 0b1100_0000_0000
    other = send(host, (0.0, 0.0, 20.0), (1.0, 0.0, 0.0), acceleration)
    assert (other.afx, other.afy, other.afz) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("height", "down"), [(20.0, 2.0), (5.0, 1.0), (2.0, 0.0), (0.0, 0.0)])
def test_no_velocity_leads_to_the_ground_if_the_program_ends(host, height, down):
    message = send(host, [math.nan] * 3, (1.0, 0.0, -2.0), relative_alt=round(1e3 * height))
    assert isinstance(message, common.SetPositionTargetLocalNed)
    assert (message.vx, message.vy, message.vz) == pytest.approx((1.0, 0.0, down))
    assert int(message.type_mask) == 0b1101_1100_0111


def test_a_member_without_a_new_setpoint_gets_its_last_one_again(host):
    members = [Member(1, **HERE), Member(2, **HERE)]
    fleet = Fleet(members, FRAME)
    rows = [((north, 0.0, 20.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)) for north in (5.0, 9.0, 6.0)]
    heights = fleet.read().heights
    fleet.send(members, setpoints(*rows[:2]), heights)
    first = [message.lat_int for message in host.sent]
    host.time += 0.1
    fleet.send(members[:1], setpoints(rows[2]), heights[:1])
    assert [message.lat_int for message in host.sent] == [first[0] + 90, first[1]]
    assert [message.time_boot_ms for message in host.sent] == [100, 0]
    members[0].is_following = False
    fleet.send([], setpoints(), heights[:0])
    assert [message.target_system for message in host.sent] == [2]
    assert [each.taken for each in members] == [1, 1]


@pytest.mark.parametrize("north", [5.0, math.nan])
def test_a_member_without_a_new_setpoint_does_not_fly_on(host, north):
    member = Member(1, **HERE, follows_acceleration=True)
    fleet = Fleet([member], FRAME)
    moving = setpoints(((north, 0.0, 20.0), (4.0, 2.0, 1.0), (1.0, 1.0, 1.0)))
    fleet.send([member], moving, fleet.read().heights)
    (first,) = host.sent
    fleet.send([], setpoints(), np.empty(0))
    assert host.sent == [first.replace(vx=0.0, vy=0.0, vz=0.0, afx=0.0, afy=0.0, afz=0.0)]
    assert first.vx == 4.0
    fleet.send([member], moving, fleet.read().heights)
    assert host.sent == [first]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_place_that_is_known_in_part_is_not_flown_to(host, axis):
    place = [10.0, 20.0, 20.0]
    place[axis] = math.nan
    assert isinstance(send(host, place, (1.0, 2.0, 0.5)), common.SetPositionTargetLocalNed)


def test_each_member_is_checked_in_turn(host):
    members = [Member(system, **HERE) for system in range(1, 8)]
    fleet = Fleet(members, FRAME)
    for _ in range(10):
        fleet.check()
    assert [each.checks for each in members] == [2] * 7
