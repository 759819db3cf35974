"""Uploads to the mission server, from a ground station controlled by the test."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import mavstack
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.mission import (
    MissionItem,
    MissionServerOptions,
    Plan,
    PlanReplaced,
    PlanType,
)
from tests.services.mission.scripted_peer import kinds, plan_of, seqs, to_vehicle
from tests.services.mission.server_harness import OTHER, make_server, result_of
from tests.services.network import GROUND, VEHICLE

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services import Address

Result = common.MavMissionResult


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

    station = make_server(validate=validate)
    old = plan_of(3)
    station.upload(old)
    assert result_of(station.upload(plan_of(2))) == Result.INVALID
    assert station.service.plan(PlanType.MISSION) == old
    # The refusal is said again to one who did not hear it, and is no beginning of anything.
    assert result_of(station.item(plan_of(2), 1)) == Result.INVALID


def test_item_can_be_refused_on_its_own() -> None:
    def check(plan_type: int, seq: int, item: MissionItem) -> int:
        return Result.ACCEPTED if item.param1 == 0 else Result.INVALID_PARAM1

    station = make_server(check=check)
    station.count(3)
    assert result_of(station.item(plan_of(3, speed=1.0), 0)) == Result.INVALID_PARAM1
    assert station.service.next_timeout() is None


def test_limits_and_types() -> None:
    station = make_server(options=MissionServerOptions(limits={PlanType.MISSION: 10}))
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
    other = make_server()
    other.count(1)
    other.now += 0.2
    assert kinds(other.send(common.MissionAck(type=Result.UNSUPPORTED, **to_vehicle()))) == ["MissionRequest"]


def test_an_item_is_not_requested_again_too_soon() -> None:
    pauses = []
    for station in (make_server(), make_server(options=MissionServerOptions(request_interval=1.0))):
        station.count(3)
        station.now += 0.001
        assert seqs(station.item(plan_of(3), 0)) == [1]
        pauses.append(station.service.next_timeout() - station.now)
    assert pauses[0] < 0.5
    assert pauses[1] == pytest.approx(1.0, abs=0.01)


class StoringElsewhere:
    """A station whose vehicle stores plans on another device; `waiting` are the plans that it stores now."""

    def __init__(self) -> None:
        self.waiting: list[tuple[Plan, Address]] = []
        self.station = make_server(store_elsewhere=lambda plan, source: self.waiting.append((plan, source)))

    def finish(self, result: int = Result.ACCEPTED) -> list[Message]:
        plan, source = self.waiting.pop(0)
        self.station.service.finish_storing(plan, source, result, self.station.now)
        return self.station.receive()


def test_a_plan_that_is_stored_elsewhere_is_acknowledged_at_the_end() -> None:
    storing, plan = StoringElsewhere(), plan_of(2)
    station = storing.station
    assert kinds(station.upload(plan)) == []
    assert kinds(station.item(plan, 1)) == []  # the client repeats it, and nothing is asked for again
    assert station.wait_for_all(20) == []
    assert result_of(station.count(1, source=OTHER)) == Result.DENIED
    assert result_of(storing.finish()) == Result.ACCEPTED
    assert station.service.plan(PlanType.MISSION) == plan
    assert station.service.events() == [PlanReplaced(plan, GROUND)]
    assert result_of(station.item(plan, 1)) == Result.ACCEPTED


def test_a_plan_that_could_not_be_stored_elsewhere_is_refused() -> None:
    storing, old = StoringElsewhere(), plan_of(3)
    storing.station.upload(old)
    storing.finish()
    storing.station.upload(plan_of(2))
    assert result_of(storing.finish(Result.ERROR)) == Result.ERROR
    assert storing.station.service.plan(PlanType.MISSION) == old


def test_clearing_of_plans_that_are_stored_elsewhere() -> None:
    storing = StoringElsewhere()
    station = storing.station
    station.upload(plan_of(2))
    storing.finish()
    assert kinds(station.clear()) == kinds(station.clear()) == []
    assert len(storing.waiting) == 1
    assert result_of(storing.finish()) == Result.ACCEPTED
    assert len(station.service.plan(PlanType.MISSION)) == 0


def test_clearing_during_an_upload_that_is_stored_elsewhere() -> None:
    storing, plan = StoringElsewhere(), plan_of(2)
    storing.station.upload(plan)
    storing.station.clear()
    assert [len(waiting) for waiting, _ in storing.waiting] == [2, 0]
    assert [kind for kind in kinds(storing.finish()) if kind == "MissionAck"] == []
    assert result_of(storing.finish()) == Result.ACCEPTED
    assert len(storing.station.service.plan(PlanType.MISSION)) == 0
