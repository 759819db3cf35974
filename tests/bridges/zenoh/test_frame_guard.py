from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack import encode
from mavstack.bridges.zenoh.frame_guard import FrameGuard
from mavstack.dialects import Dialect, Message, common
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from mavstack.wire import Packet

ALL = Dialect.load("all")
ARM = common.CommandLong(target_system=1, target_component=1, command=common.MavCmd.COMPONENT_ARM_DISARM)
STEER = common.SetPositionTargetLocalNed(target_system=1, target_component=1)
SETTING = common.ParamSet(target_system=1, target_component=1, param_id="RTL_ALT")


def data(message: Message, system: int = 255) -> bytes:
    return encode(message, system=system, component=190, sequence=0)


def names(packets: list[Packet]) -> list[str | None]:
    return [packet.name for packet in packets]


def test_packets_pass_by_the_role() -> None:
    sample = data(ARM) + data(STEER) + data(SETTING)
    pilot, administrator = FrameGuard(1, Role.OPERATE, ALL), FrameGuard(1, Role.ADMINISTER, ALL)
    assert names(pilot.accept(sample, "a", 0.0, 1.0)) == ["COMMAND_LONG", "SET_POSITION_TARGET_LOCAL_NED"]
    assert len(administrator.accept(sample, "a", 0.0, 1.0)) == 3
    assert administrator.accepted == 3


@pytest.mark.parametrize(
    ("age", "passed"), [(0.0, [True, True]), (0.4, [True, True]), (0.6, [True, False]), (2.5, [False, False])]
)
def test_late_packets_are_refused(age: float, passed: list[bool]) -> None:
    guard = FrameGuard(1, Role.ADMINISTER, ALL)
    guard.accept(data(common.Heartbeat()), "a", 0.0, 0.1)
    found = [bool(guard.accept(data(each), "a", 10.0, 10.1 + age)) for each in (ARM, STEER)]
    assert found == passed
    assert sum(guard.refused.values()) == passed.count(False)


def test_without_a_time_nothing_steers() -> None:
    guard = FrameGuard(1, Role.ADMINISTER, ALL)
    assert names(guard.accept(data(ARM) + data(STEER), "", None, 1.0)) == ["COMMAND_LONG"]
    assert guard.refused == {"steers and is late": 1}


def test_a_vehicle_gets_its_own_packets_only() -> None:
    guard = FrameGuard(1, Role.ADMINISTER, ALL)
    other = common.CommandLong(target_system=2, command=common.MavCmd.COMPONENT_ARM_DISARM)
    assert guard.accept(data(other), "a", 0.0, 0.1) == []
    assert guard.accept(data(common.Heartbeat(), system=1), "a", 0.0, 0.1) == []
    assert len(guard.accept(data(common.Heartbeat()), "a", 0.0, 0.1)) == 1
    assert guard.refused == {"is for another vehicle": 1, "has the ids of the vehicle": 1}
    assert len(FrameGuard(None, Role.ADMINISTER, ALL).accept(data(other), "a", 0.0, 0.1)) == 1


@given(st.binary(max_size=300), st.none() | st.floats(allow_nan=False, allow_infinity=False))
def test_any_bytes_pass_or_are_skipped(sample: bytes, stamp: float | None) -> None:
    for role in (Role.OPERATE, Role.ADMINISTER):
        assert isinstance(FrameGuard(1, role, ALL).accept(sample, "a", stamp, 1.0), list)
