"""Mission server, against a ground station controlled by the test."""

from __future__ import annotations

import pytest

import mavstack
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services import Address
from mavstack.services.command import Command, CommandServer
from mavstack.services.mission import (
    CurrentItemSet,
    MissionItem,
    MissionServerOptions,
    Plan,
    PlanStore,
    PlanType,
)
from tests.services.mission.scripted_peer import ScriptedStation, kinds, plan_of, seqs, to_vehicle, waypoints
from tests.services.mission.server_harness import make_server, result_of
from tests.services.network import GROUND, VEHICLE

Result = common.MavMissionResult


def test_late_copy_of_clearing_does_not_clear_again(station) -> None:
    clear = common.MissionClearAll(**to_vehicle())
    raw = mavstack.encode(clear, system=255, component=190, sequence=9)
    assert result_of(station.send_raw(raw)) == Result.ACCEPTED
    station.upload(plan_of(1))
    assert station.send_raw(raw) == []
    assert len(station.service.plan(0)) == 1


def test_clearing_all() -> None:
    station = make_server()
    for kind in (0, 1, 2):
        station.upload(plan_of(2, kind))
    received = station.clear(PlanType.ALL)
    assert result_of(received) == Result.ACCEPTED
    assert [len(station.service.plan(kind)) for kind in (0, 1, 2)] == [0, 0, 0]
    assert received[-2].total == 0xFFFF
    assert received[-2].mission_state == common.MissionState.NO_MISSION


def test_clearing_all_is_all_or_nothing() -> None:
    def validate(plan: Plan, source: Address) -> int:
        return Result.DENIED if plan.type == PlanType.RALLY and not plan.items else Result.ACCEPTED

    station = make_server(validate=validate)
    for kind in (0, 1, 2):
        station.upload(plan_of(2, kind))
    assert result_of(station.clear(PlanType.ALL)) == Result.DENIED
    assert [len(station.service.plan(kind)) for kind in (0, 1, 2)] == [2, 2, 2]


def test_empty_upload_clears(station) -> None:
    station.upload(plan_of(2))
    assert result_of(station.count(0)) == Result.ACCEPTED
    assert station.service.plan(0) == Plan(0)


def test_partial_lists_are_refused(station) -> None:
    station.upload(plan_of(4))
    write = common.MissionWritePartialList(start_index=1, end_index=2, **to_vehicle())
    read = common.MissionRequestPartialList(start_index=1, end_index=2, **to_vehicle())
    assert result_of(station.send(write)) == Result.UNSUPPORTED
    assert result_of(station.send(read)) == Result.UNSUPPORTED
    assert station.service.plan(0) == plan_of(4)


def test_set_current(station) -> None:
    station.upload(plan_of(4))
    station.service.events()
    (current,) = station.send(common.MissionSetCurrent(seq=2, **to_vehicle()))
    assert (current.seq, current.total) == (2, 4)
    assert station.service.events() == [CurrentItemSet(2, GROUND)]
    station.list()
    assert [station.request(seq)[0].current for seq in range(4)] == [0, 0, 1, 0]
    (text,) = station.send(common.MissionSetCurrent(seq=4, **to_vehicle()))
    assert (type(text), text.severity) == (common.Statustext, common.MavSeverity.WARNING)
    assert station.service.current == 2


def test_set_current_by_command(station) -> None:
    server, commands, touched = station.service, CommandServer(VEHICLE), []
    server.answer_commands(commands, touched.append)
    station.upload(plan_of(4))
    server.events()
    handler = ScriptedStation(commands)

    def ask(*params: float) -> int:
        command = Command(common.MavCmd.DO_SET_MISSION_CURRENT, *params)
        (ack,) = handler.send(command.to_long(VEHICLE))
        return ack.result

    assert ask(3) == common.MavResult.ACCEPTED
    assert touched == [server]
    assert [message.seq for message in station.receive()] == [3]
    assert ask(-1, 1) == common.MavResult.ACCEPTED
    assert server.events() == [CurrentItemSet(3, GROUND), CurrentItemSet(3, GROUND, restart=True)]
    for wrong in (4, -2, float("nan"), float("inf")):
        assert ask(wrong) == common.MavResult.DENIED


def test_program_moves_the_mission(station) -> None:
    server = station.service
    server.replace(Plan.of([*waypoints(2), MissionItem(16, current=True)]))
    assert server.current == 2
    server.set_current(1)
    server.reached(1)
    received = station.receive()
    assert kinds(received) == ["MissionCurrent", "MissionCurrent", "MissionItemReached"]
    assert seqs(received) == [2, 1, 1]
    with pytest.raises(InvalidArgumentError):
        server.set_current(3)


def test_vehicle_without_ids() -> None:
    station = make_server(options=MissionServerOptions(plan_ids=False))
    received = station.upload(plan_of(2))
    assert (received[0].mission_id, received[1].opaque_id) == (0, 0)


def test_home_is_item_0_where_it_is() -> None:
    station = make_server(options=MissionServerOptions(home_first=True))
    station.service.home = home = MissionItem(common.MavCmd.NAV_WAYPOINT, param5=1.0, param6=2.0)
    plan = plan_of(3)
    received = station.upload(plan)
    assert received[0].total == 2
    station.list()
    items = [MissionItem.read(station.request(seq)[0]) for seq in range(3)]
    assert items == [home, *plan.items[1:]]
    station.upload(plan_of(3, PlanType.RALLY))
    assert station.service.plan(PlanType.RALLY) == plan_of(3, PlanType.RALLY)


def test_home_can_be_read_while_the_mission_is_empty() -> None:
    station = make_server(options=MissionServerOptions(home_first=True, float_answers=True))
    request = common.MissionRequest(seq=0, **to_vehicle())
    (unknown,) = station.send(request)
    assert (unknown.command, unknown.x, unknown.y) == (common.MavCmd.NAV_WAYPOINT, 0.0, 0.0)
    station.service.home = MissionItem(common.MavCmd.NAV_WAYPOINT, param5=47.0, param6=8.0)
    (count,) = station.list()
    assert count.count == 0
    (item,) = station.send(request)
    assert (item.seq, item.x, item.y) == (0, 47.0, 8.0)
    assert station.request(0)[0].x == 470_000_000
    assert result_of(station.request(0, PlanType.RALLY)) == Result.ERROR


def test_plans_and_ids_outlive_a_restart() -> None:
    store = PlanStore()
    station = make_server(store=store)
    station.upload(plan_of(3))
    again = make_server(store=store)
    assert again.service.plan(0) == plan_of(3)
    assert again.service.plan(0).plan_id == station.service.plan(0).plan_id
    assert result_of(again.request(0)) == Result.ERROR  # of which plan, it would not know


def test_tables_are_bounded(station) -> None:
    station.upload(plan_of(100))
    for system in range(1, 255):
        station.list(source=Address(system, 1))
        for kind in range(3):
            station.count(0, kind, source=Address(system, 2))
    assert len(station.service._downloads._clients) <= 64
    assert len(station.service._uploads._ended) <= 64
    station.service.replace(plan_of(500))
    station.list()
    for seq in range(500):
        raw = mavstack.encode(
            common.MissionRequestInt(seq=seq, **to_vehicle()), system=255, component=190, sequence=seq % 256
        )
        station.service.receive(mavstack.wire.Packet(raw, common), station.now)
    assert len(station.receive()) <= 256 + 2


def test_a_firmware_may_keep_to_the_older_messages() -> None:
    station = make_server(options=MissionServerOptions(plain_requests=True, float_answers=True))
    plan = plan_of(3)
    assert kinds(station.count(3)) == ["MissionRequest"]
    assert kinds(station.item(plan, 0)) == ["MissionRequest"]
    assert kinds(station.send(plan.items[1].to_float(VEHICLE, 1, 0))) == ["MissionRequest"]
    assert result_of(station.item(plan, 2)) == Result.ACCEPTED
    station.list()
    assert kinds(station.send(common.MissionRequest(seq=1, **to_vehicle()))) == ["MissionItem"]
    assert kinds(station.send(common.MissionRequestInt(seq=1, **to_vehicle()))) == ["MissionItemInt"]
