"""Downloads from the mission server, by a ground station controlled by the test."""

from __future__ import annotations

import mavstack
from mavstack.dialects import common
from mavstack.services.mission import (
    MissionItem,
    MissionServerOptions,
    PlanType,
)
from tests.services.mission.scripted_peer import kinds, plan_of, seqs, to_vehicle
from tests.services.mission.server_harness import OTHER, make_server, result_of
from tests.services.network import GROUND

Result = common.MavMissionResult


def test_old_request_is_answered_with_integers_unless_it_is_mavlink_1(station) -> None:
    station.upload(plan_of(2))
    station.list()
    request = common.MissionRequest(seq=1, **to_vehicle())
    assert kinds(station.send(request)) == ["MissionItemInt"]
    assert kinds(station.send(request, version=1)) == ["MissionItem"]


def test_several_download_at_once_and_in_any_order(station) -> None:
    plan = plan_of(4)
    station.upload(plan)
    for source in (GROUND, OTHER):
        (count,) = station.list(source=source)
        assert (count.count, count.opaque_id) == (4, station.service.plan(0).plan_id)
        assert count.target_system == source.system
    for seq in (0, 3, 1, 1, 2):
        for source in (GROUND, OTHER):
            (item,) = station.request(seq, source=source)
            assert (item.seq, item.target_system) == (seq, source.system)
            assert MissionItem.read(item) == plan.items[seq]
    assert result_of(station.request(4)) == Result.INVALID_SEQUENCE


def test_download_never_mixes_two_plans(station) -> None:
    station.upload(plan_of(3))
    station.list()
    station.request(0)
    station.count(3, source=OTHER)
    assert kinds(station.request(1)) == ["MissionItemInt"]  # the old one is there until the new is whole
    for seq in range(3):
        station.item(plan_of(3, speed=5.0), seq, source=OTHER)
    assert result_of(station.request(2)) == Result.ERROR
    station.list()
    assert station.request(2)[0].param1 == 5.0


def test_items_wait_for_room(station) -> None:
    station.upload(plan_of(2))
    station.list()
    server, full = station.service, True
    request = common.MissionRequestInt(seq=0, **to_vehicle())
    raw = mavstack.encode(request, system=255, component=190, sequence=3)
    server.receive(mavstack.wire.Packet(raw, common), station.now)
    assert list(server.messages_to_send(station.now, lambda target, priority=0: not full)) == []
    full = False
    assert seqs(station.receive()) == [0]


def test_request_beyond_the_mission_is_answered_with_its_count_by_ardupilot() -> None:
    station = make_server(options=MissionServerOptions(home_first=True))
    station.upload(plan_of(3))
    station.list()
    answers = station.request(3)
    assert kinds(answers) == ["MissionCount", "MissionAck"]
    assert (answers[0].count, answers[1].type) == (3, Result.ERROR)
    station.list(PlanType.FENCE)
    assert result_of(station.request(0, PlanType.FENCE)) == Result.INVALID_SEQUENCE
