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
    MissionServer,
    MissionServerOptions,
    Plan,
    PlanReplaced,
    PlanStore,
    PlanType,
)
from tests.services.mission.scripted_peer import ScriptedStation, kinds, plan_of, seqs, to_vehicle, waypoints
from tests.services.network import GROUND, VEHICLE

Result = common.MavMissionResult
OTHER = Address(254, 190)


def make(*, store=None, options=None, **callbacks) -> ScriptedStation:
    return ScriptedStation(MissionServer(VEHICLE, store, options, **callbacks))


@pytest.fixture
def station() -> ScriptedStation:
    return make()


def result_of(messages: list) -> int:
    (ack,) = [message for message in messages if isinstance(message, common.MissionAck)]
    return ack.type


def test_plan_is_taken_when_it_is_whole(station) -> None:
    plan, server = plan_of(3), station.service
    assert seqs(station.count(3)) == [0]
    assert seqs(station.item(plan, 0)) == [1]
    assert seqs(station.item(plan, 1)) == [2]
    assert len(server.plan(PlanType.MISSION)) == 0
    received = station.item(plan, 2)
    assert kinds(received) == ["MissionCurrent", "MissionAck"]
    assert server.plan(PlanType.MISSION) == plan
    assert received[0].mission_id == received[1].opaque_id == server.plan(PlanType.MISSION).plan_id != 0
    assert server.events() == [PlanReplaced(plan, GROUND)]


def test_mission_fence_and_rally_are_independent(station) -> None:
    for number, kind in enumerate((PlanType.MISSION, PlanType.FENCE, PlanType.RALLY), 1):
        station.upload(plan_of(number, kind))
    assert [len(station.service.plan(kind)) for kind in (0, 1, 2)] == [1, 2, 3]
    station.clear(PlanType.FENCE)
    assert [len(station.service.plan(kind)) for kind in (0, 1, 2)] == [1, 0, 3]


def test_second_uploader_is_refused_while_the_first_is_at_it(station) -> None:
    plan = plan_of(2)
    station.count(2)
    assert result_of(station.count(5, source=OTHER)) == Result.DENIED
    assert result_of(station.clear(source=OTHER)) == Result.DENIED
    assert kinds(station.count(5, PlanType.FENCE, source=OTHER)) == ["MissionRequestInt"]
    station.item(plan, 0)
    assert result_of(station.item(plan_of(2, speed=9.0), 1, source=OTHER)) == Result.ERROR
    assert result_of(station.item(plan, 1)) == Result.ACCEPTED
    assert station.service.plan(PlanType.MISSION) == plan
    assert kinds(station.count(5, source=OTHER)) == ["MissionRequestInt"]


def test_old_plan_stays_until_the_new_one_was_accepted() -> None:
    def validate(plan: Plan, source: Address) -> int:
        return Result.INVALID if len(plan) == 2 else Result.ACCEPTED

    station = make(validate=validate)
    old = plan_of(3)
    station.upload(old)
    assert result_of(station.upload(plan_of(2))) == Result.INVALID
    assert station.service.plan(PlanType.MISSION) == old
    # The refusal is said again to one who did not hear it, and is no beginning of anything.
    assert result_of(station.item(plan_of(2), 1)) == Result.INVALID


def test_item_can_be_refused_on_its_own() -> None:
    def check(plan_type: int, seq: int, item: MissionItem) -> int:
        return Result.ACCEPTED if item.param1 == 0 else Result.INVALID_PARAM1

    station = make(check=check)
    station.count(3)
    assert result_of(station.item(plan_of(3, speed=1.0), 0)) == Result.INVALID_PARAM1
    assert station.service.next_timeout() is None


def test_limits_and_types() -> None:
    station = make(options=MissionServerOptions(limits={PlanType.MISSION: 10}))
    assert result_of(station.count(11)) == Result.NO_SPACE
    assert seqs(station.count(10)) == [0]
    for kind in (PlanType.FENCE, PlanType.ALL, 77):
        assert result_of(station.count(1, kind)) == Result.UNSUPPORTED
        assert result_of(station.list(kind)) == Result.UNSUPPORTED
        assert result_of(station.request(0, kind)) == Result.UNSUPPORTED
    assert result_of(station.clear(PlanType.FENCE)) == Result.UNSUPPORTED
    with pytest.raises(InvalidArgumentError):
        station.service.replace(plan_of(11))
    with pytest.raises(InvalidArgumentError):
        station.service.replace(plan_of(1, PlanType.FENCE))


def test_items_are_requested_again_by_the_round_trip(station) -> None:
    plan = plan_of(20)
    station.count(20)
    begin = station.now
    assert seqs(station.wait()) == [0]
    assert station.now - begin == pytest.approx(0.25)
    for seq in range(10):
        station.item(plan, seq)
        station.now += 0.04
    assert station.service.next_timeout() - station.now < 0.1


def test_silent_uploader_is_reported_and_dropped(station) -> None:
    station.upload(plan_of(3))
    station.count(2)
    station.item(plan_of(2), 0)
    begin = station.now
    received = station.wait_for_all(60)
    assert result_of(received) == Result.OPERATION_CANCELLED
    assert 10 < len(received) <= 20
    assert begin + 60 == station.now
    assert station.service.next_timeout() is None
    assert len(station.service.plan(PlanType.MISSION)) == 3
    assert result_of(station.item(plan_of(2), 1)) == Result.ERROR


def test_uploader_can_cancel(station) -> None:
    station.count(2)
    station.send(common.MissionAck(type=Result.ACCEPTED, **to_vehicle()))
    assert station.service.next_timeout() is not None
    station.send(common.MissionAck(type=Result.OPERATION_CANCELLED, **to_vehicle()), source=OTHER)
    assert station.service.next_timeout() is not None
    received = station.send(common.MissionAck(type=Result.OPERATION_CANCELLED, **to_vehicle()))
    assert result_of(received) == Result.OPERATION_CANCELLED
    assert station.service.next_timeout() is None


def test_wrong_item_brings_the_request_again_but_not_a_storm(station) -> None:
    plan = plan_of(5)
    station.count(5)
    station.now += 0.04
    station.item(plan, 0)
    assert station.item(plan, 0) == []
    station.now += 0.04
    assert seqs(station.item(plan, 0)) == [1]
    assert station.item(plan, 3) == []
    station.now += 0.04
    assert seqs(station.item(plan, 3)) == [1]


def test_last_item_again_brings_the_last_acknowledgement_again(station) -> None:
    plan = plan_of(2)
    station.upload(plan)
    station.service.events()
    for _ in range(2):
        (ack,) = station.item(plan, 1)
        assert (ack.type, ack.opaque_id) == (Result.ACCEPTED, station.service.plan(0).plan_id)
    assert station.item(plan, 0) == []
    assert result_of(station.item(plan_of(5), 4)) == Result.ERROR
    assert station.service.events() == []


def test_count_again_begins_again_but_a_copy_does_not(station) -> None:
    plan = plan_of(3)
    raw = mavstack.encode(common.MissionCount(count=3, **to_vehicle()), system=255, component=190, sequence=9)
    assert seqs(station.send_raw(raw)) == [0]
    station.item(plan, 0)
    assert station.send_raw(raw) == []
    station.item(plan, 1)
    assert seqs(station.count(3)) == [0]
    for seq in range(3):
        received = station.item(plan, seq)
    assert result_of(received) == Result.ACCEPTED


def test_late_copy_of_the_count_begins_nothing(station) -> None:
    raw = mavstack.encode(common.MissionCount(count=1, **to_vehicle()), system=255, component=190, sequence=9)
    station.send_raw(raw)
    station.item(plan_of(1), 0)
    assert station.send_raw(raw) == []
    station.now += 10
    assert seqs(station.send_raw(raw)) == [0]


def test_late_count_that_was_sent_twice_begins_nothing(station) -> None:
    station.count(1)
    assert result_of(station.item(plan_of(1), 0)) == Result.ACCEPTED
    assert station.count(1) == []
    assert seqs(station.count(2)) == [0]


def test_late_copy_of_clearing_does_not_clear_again(station) -> None:
    clear = common.MissionClearAll(**to_vehicle())
    raw = mavstack.encode(clear, system=255, component=190, sequence=9)
    assert result_of(station.send_raw(raw)) == Result.ACCEPTED
    station.upload(plan_of(1))
    assert station.send_raw(raw) == []
    assert len(station.service.plan(0)) == 1


def test_old_uploads_with_floats_are_taken(station) -> None:
    plan = plan_of(2)
    station.count(2, version=1)
    received = station.send(plan.items[0].to_float(VEHICLE, 0, 0), version=1)
    assert (kinds(received), seqs(received)) == (["MissionRequest"], [1])
    received = station.send(plan.items[1].to_float(VEHICLE, 1, 0), version=1)
    assert result_of(received) == Result.ACCEPTED
    assert len(station.service.plan(0)) == 2


def test_one_who_knows_only_the_old_request_is_requested_with_it(station) -> None:
    station.count(1)
    assert "MissionRequest" in kinds(station.wait_for_all(2.0))
    other = make()
    other.count(1)
    other.now += 0.2
    assert kinds(other.send(common.MissionAck(type=Result.UNSUPPORTED, **to_vehicle()))) == ["MissionRequest"]


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


def test_clearing_all() -> None:
    station = make()
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

    station = make(validate=validate)
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
    station = make(options=MissionServerOptions(plan_ids=False))
    received = station.upload(plan_of(2))
    assert (received[0].mission_id, received[1].opaque_id) == (0, 0)


def test_home_is_item_0_where_it_is() -> None:
    station = make(options=MissionServerOptions(home_first=True))
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
    station = make(options=MissionServerOptions(home_first=True, float_answers=True))
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


def test_request_beyond_the_mission_is_answered_with_its_count_by_ardupilot() -> None:
    station = make(options=MissionServerOptions(home_first=True))
    station.upload(plan_of(3))
    station.list()
    answers = station.request(3)
    assert kinds(answers) == ["MissionCount", "MissionAck"]
    assert (answers[0].count, answers[1].type) == (3, Result.ERROR)
    station.list(PlanType.FENCE)
    assert result_of(station.request(0, PlanType.FENCE)) == Result.INVALID_SEQUENCE


def test_plans_and_ids_outlive_a_restart() -> None:
    store = PlanStore()
    station = make(store=store)
    station.upload(plan_of(3))
    again = make(store=store)
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
    station = make(options=MissionServerOptions(plain_requests=True, float_answers=True))
    plan = plan_of(3)
    assert kinds(station.count(3)) == ["MissionRequest"]
    assert kinds(station.item(plan, 0)) == ["MissionRequest"]
    assert kinds(station.send(plan.items[1].to_float(VEHICLE, 1, 0))) == ["MissionRequest"]
    assert result_of(station.item(plan, 2)) == Result.ACCEPTED
    station.list()
    assert kinds(station.send(common.MissionRequest(seq=1, **to_vehicle()))) == ["MissionItem"]
    assert kinds(station.send(common.MissionRequestInt(seq=1, **to_vehicle()))) == ["MissionItemInt"]


def test_an_item_is_not_requested_again_too_soon() -> None:
    pauses = []
    for station in (make(), make(options=MissionServerOptions(request_interval=1.0))):
        station.count(3)
        station.now += 0.001
        assert seqs(station.item(plan_of(3), 0)) == [1]
        pauses.append(station.service.next_timeout() - station.now)
    assert pauses[0] < 0.5
    assert pauses[1] == pytest.approx(1.0, abs=0.01)
