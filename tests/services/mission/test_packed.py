"""ArduPilot's plan files: compatibility, and rejection of damaged files."""

from __future__ import annotations

import struct
from math import nan

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as pymavlink

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services import Address
from mavstack.services.mission import (
    MissionItem,
    MissionServer,
    MissionServerOptions,
    Plan,
    PlanType,
    pack_plan,
    unpack_plan,
)

PLAN = Plan.of(
    [
        MissionItem(common.MavCmd.NAV_TAKEOFF, param7=20.0),
        MissionItem(common.MavCmd.NAV_WAYPOINT, 1, 2, 3, nan, 47.3977418, 8.5455939, 50.0),
        MissionItem(common.MavCmd.NAV_RETURN_TO_LAUNCH, frame=common.MavFrame.MISSION),
    ]
)


def test_pymavlink_reads_it() -> None:
    data = pack_plan(PLAN, current=1)
    magic, kind, options, first, count = struct.unpack_from("<HHHHH", data)
    assert (magic, kind, options, first, count) == (0x763D, PlanType.MISSION, 0, 0, 3)
    message = pymavlink.MAVLink_mission_item_int_message
    assert len(data) == 10 + 3 * message.unpacker.size
    for seq, item in enumerate(PLAN.items):
        values = message.unpacker.unpack_from(data, 10 + seq * message.unpacker.size)
        found = message(*(values[place] for place in message.orders))
        wanted = item.to_int(Address(0, 0), seq, PlanType.MISSION)
        assert (found.seq, found.command, found.frame, found.x, found.y, found.z) == (
            seq,
            wanted.command,
            wanted.frame,
            wanted.x,
            wanted.y,
            wanted.z,
        )
        assert found.current == (seq == 1)


@pytest.mark.parametrize("kind", [PlanType.MISSION, PlanType.FENCE, PlanType.RALLY])
def test_what_is_packed_comes_back(kind) -> None:
    plan = Plan.of(PLAN.items, kind)
    found = unpack_plan(pack_plan(plan))
    assert found is not None
    assert found.plan == plan
    assert found.applied_to(Plan(kind)) == plan
    assert unpack_plan(pack_plan(Plan(kind))).plan == Plan(kind)


def test_a_part_replaces_a_part() -> None:
    data = bytearray(pack_plan(Plan.of(PLAN.items[:1])))
    struct.pack_into("<HH", data, 4, 1, 2)
    found = unpack_plan(bytes(data))
    assert found.applied_to(PLAN).items == (*PLAN.items[:2], PLAN.items[0])
    assert found.applied_to(Plan.of(PLAN.items[:2])).items == (*PLAN.items[:2], PLAN.items[0])
    assert found.applied_to(Plan.of(PLAN.items[:1])) is None
    struct.pack_into("<HH", data, 4, 0, 2)
    assert unpack_plan(bytes(data)).applied_to(PLAN) is None


def test_what_is_damaged_is_not_taken() -> None:
    data = pack_plan(PLAN)
    assert unpack_plan(b"") is None
    assert unpack_plan(data[:-1]) is None
    assert unpack_plan(data + b"x") is None
    assert unpack_plan(b"x" + data[1:]) is None
    assert unpack_plan(data[:48] + bytes(38) + data[86:]) is None
    with pytest.raises(InvalidArgumentError):
        pack_plan(Plan.of([PLAN.items[0]] * 65536))


@given(st.binary(max_size=200))
def test_garbage_never_raises(data) -> None:
    unpack_plan(data)
    header = struct.pack("<HHHHH", 0x763D, 0, 0, 0, len(data) // 38)
    found = unpack_plan(header + data[: len(data) // 38 * 38])
    assert found is None or len(found.plan) == len(data) // 38


def test_a_server_judges_a_plan_that_came_whole() -> None:
    result = common.MavMissionResult

    def check(kind: int, seq: int, item: MissionItem) -> int:
        return result.INVALID_PARAM1 if item.param1 == 9 else result.ACCEPTED

    server = MissionServer(
        Address(1, 1), options=MissionServerOptions(limits={PlanType.MISSION: 3}), check=check
    )
    assert server.accept(PLAN, Address(0, 0)) == result.ACCEPTED
    assert server.plan(PlanType.MISSION) == PLAN
    assert server.accept(Plan.of([MissionItem(16, param1=9)]), Address(0, 0)) == result.INVALID_PARAM1
    assert server.accept(Plan.of([MissionItem(16)] * 4), Address(0, 0)) == result.NO_SPACE
    assert server.accept(Plan.of([], PlanType.FENCE), Address(0, 0)) == result.UNSUPPORTED
    assert server.plan(PlanType.MISSION) == PLAN
