"""Downloads, clearing and the current item, against a vehicle controlled by the test."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import (
    CommandDenied,
    InvalidArgumentError,
    MissionDenied,
    MissionTimeout,
    RemoteCancelled,
)
from mavstack.services.command import CommandClient
from mavstack.services.mission import (
    ItemReached,
    MissionClient,
    MissionItem,
    MissionProgress,
    Plan,
    PlanType,
    set_current_item,
)
from tests.services.mission.scripted_peer import ScriptedVehicle, kinds, plan_of, seqs, to_ground
from tests.services.network import GROUND, VEHICLE

Result = common.MavMissionResult


@pytest.fixture
def client() -> MissionClient:
    return MissionClient(GROUND, VEHICLE)


@pytest.fixture
def vehicle(client) -> ScriptedVehicle:
    return ScriptedVehicle(client)


def begin(vehicle: ScriptedVehicle, kind: int = PlanType.MISSION, **options):
    download = vehicle.service.download(vehicle.now, kind, **options)
    return download, vehicle.receive()


def test_items_come_one_by_one_and_the_last_is_acknowledged(vehicle) -> None:
    plan = plan_of(3, PlanType.FENCE)
    download, received = begin(vehicle, PlanType.FENCE)
    assert (kinds(received), received[0].mission_type) == (["MissionRequestList"], PlanType.FENCE)
    received = vehicle.count(3, PlanType.FENCE, plan_id=4)
    for seq in range(3):
        assert (kinds(received), seqs(received)) == (["MissionRequestInt"], [seq])
        received = vehicle.item(plan, seq)
    (ack,) = received
    assert (type(ack), ack.type, ack.mission_type) == (common.MissionAck, Result.ACCEPTED, PlanType.FENCE)
    assert download.result() == plan
    assert download.result().plan_id == 4


def test_only_the_item_that_is_due_is_ever_requested(vehicle) -> None:
    """PX4 ends the transfer when it is asked out of turn."""
    plan = plan_of(6)
    begin(vehicle)
    received = vehicle.count(6)
    for seq in range(3):
        vehicle.now += 0.04
        received = vehicle.item(plan, seq)
    assert seqs(received) == [3]
    before = vehicle.now
    assert seqs(vehicle.wait()) == [3]
    assert vehicle.now - before < 0.1
    assert seqs(vehicle.wait()) == [3]
    assert vehicle.item(plan, 2) == []
    assert vehicle.item(plan, 4) == []
    assert seqs(vehicle.item(plan, 3)) == [4]
    assert vehicle.item(plan, 3) == []


def test_empty_plan_is_acknowledged(vehicle) -> None:
    download, _ = begin(vehicle)
    assert kinds(vehicle.count(0)) == ["MissionAck"]
    assert download.result() == Plan(PlanType.MISSION)


def test_old_items_are_taken(vehicle) -> None:
    plan = plan_of(1)
    download, _ = begin(vehicle)
    vehicle.count(1)
    vehicle.send(plan.items[0].to_float(GROUND, 0, 0))
    assert download.result().items[0].param7 == plan.items[0].param7


def test_vehicle_that_refuses_the_new_request_gets_the_old(vehicle) -> None:
    begin(vehicle)
    vehicle.count(2)
    received = vehicle.ack(Result.UNSUPPORTED)
    assert (kinds(received), seqs(received)) == (["MissionRequest"], [0])


def test_vehicle_that_lost_the_transfer_is_requested_the_list_again(vehicle) -> None:
    plan = plan_of(2)
    download, _ = begin(vehicle)
    vehicle.count(2)
    vehicle.item(plan, 0)
    assert vehicle.ack(Result.ERROR) == vehicle.item(plan, 0) == []
    assert kinds(vehicle.wait()) == ["MissionRequestList"]
    vehicle.count(2)
    vehicle.item(plan, 0)
    vehicle.item(plan, 1)
    assert download.result() == plan


def test_vehicle_that_forgot_silently_is_requested_the_list_again(vehicle) -> None:
    begin(vehicle)
    vehicle.count(2)
    received = kinds(vehicle.wait_for_all(9.0))
    assert received[-1] == "MissionRequestList"
    assert received.count("MissionRequestInt") == 5


def test_second_count_begins_again(vehicle) -> None:
    plan = plan_of(3)
    begin(vehicle)
    vehicle.wait()
    vehicle.count(3)
    vehicle.item(plan, 0)
    assert seqs(vehicle.count(3)) == [0]


def test_count_of_another_plan_lets_everything_pass_by(vehicle) -> None:
    old, new = plan_of(3), plan_of(2, speed=1.0)
    download, _ = begin(vehicle)
    vehicle.count(3, plan_id=1)
    vehicle.item(old, 0)
    assert vehicle.count(2, plan_id=2) == []
    assert vehicle.item(old, 0) == vehicle.count(3, plan_id=1) == []
    assert kinds(vehicle.wait()) == ["MissionRequestList"]
    vehicle.count(2, plan_id=2)
    vehicle.item(new, 0)
    vehicle.item(new, 1)
    assert download.result() == new


@pytest.mark.parametrize("receiving", [False, True])
def test_denial(vehicle, receiving) -> None:
    download, _ = begin(vehicle)
    if receiving:
        vehicle.count(2)
    vehicle.ack(Result.DENIED)
    with pytest.raises(MissionDenied, match="downloading the mission from 1/1 failed: DENIED") as caught:
        download.result()
    assert caught.value.item == (0 if receiving else None)


def test_errors_without_end_end_in_denial(vehicle) -> None:
    download, _ = begin(vehicle)
    for _ in range(6):
        vehicle.count(2)
        vehicle.ack(Result.ERROR)
        if not download.done:
            vehicle.wait()
    assert isinstance(download.error, MissionDenied)


def test_silence_ends_in_a_timeout(vehicle) -> None:
    download, _ = begin(vehicle)
    received = vehicle.wait_for_all(30)
    assert isinstance(download.error, MissionTimeout)
    assert received[-1].type == Result.OPERATION_CANCELLED


def test_cancelled_by_either_side(vehicle, client) -> None:
    download, _ = begin(vehicle)
    client.cancel(download, vehicle.now)
    assert [message.type for message in vehicle.receive()] == [Result.OPERATION_CANCELLED]
    vehicle = ScriptedVehicle(MissionClient(GROUND, VEHICLE))
    other, _ = begin(vehicle)
    vehicle.ack(Result.OPERATION_CANCELLED)
    for operation in (download, other):
        with pytest.raises(RemoteCancelled):
            operation.result()


def test_the_last_acknowledgement_is_repeated(vehicle) -> None:
    plan = plan_of(1)
    begin(vehicle)
    vehicle.count(1)
    vehicle.item(plan, 0)
    assert [message.type for message in vehicle.item(plan, 0)] == [Result.ACCEPTED]


def test_no_such_plan(client) -> None:
    with pytest.raises(InvalidArgumentError):
        client.download(0.0, PlanType.ALL)
    with pytest.raises(InvalidArgumentError):
        client.clear(0.0, 9)


def test_clearing_is_repeated_until_acknowledged(vehicle) -> None:
    clearing = vehicle.service.clear(vehicle.now, PlanType.RALLY)
    received = vehicle.receive() + vehicle.wait()
    assert kinds(received) == ["MissionClearAll"] * 2
    vehicle.ack(Result.ACCEPTED, PlanType.MISSION)
    vehicle.ack(Result.ACCEPTED, PlanType.RALLY, plan_id=5)  # of an upload before it
    assert not clearing.done
    vehicle.ack(Result.ACCEPTED, PlanType.RALLY)
    assert clearing.result() is None


def test_clearing_can_be_denied_and_time_out(vehicle) -> None:
    denied = vehicle.service.clear(vehicle.now)
    vehicle.ack(Result.DENIED)
    assert isinstance(denied.error, MissionDenied)
    silent = vehicle.service.clear(vehicle.now)
    vehicle.wait_for_all(30)
    assert isinstance(silent.error, MissionTimeout)


def test_clearing_all_types_of_a_vehicle_that_knows_only_each(vehicle) -> None:
    clearing = vehicle.service.clear(vehicle.now, PlanType.ALL)
    vehicle.receive()
    cleared = [message.mission_type for message in vehicle.ack(Result.UNSUPPORTED, PlanType.ALL)]
    cleared += [message.mission_type for message in vehicle.ack(Result.ACCEPTED, PlanType.MISSION)]
    cleared += [message.mission_type for message in vehicle.ack(Result.UNSUPPORTED, PlanType.FENCE)]
    assert cleared == [PlanType.MISSION, PlanType.FENCE, PlanType.RALLY]
    vehicle.ack(Result.ACCEPTED, PlanType.RALLY)
    assert clearing.result() is None


def test_set_current_the_older_way(vehicle) -> None:
    setting = vehicle.service.set_current(3, vehicle.now)
    received = vehicle.receive() + vehicle.wait()
    assert [(kind, message.seq) for kind, message in zip(kinds(received), received, strict=True)] == [
        ("MissionSetCurrent", 3)
    ] * 2
    vehicle.send(common.MissionCurrent(seq=2))
    assert not setting.done
    vehicle.send(common.MissionCurrent(seq=3))
    assert setting.result() == 3
    silent = vehicle.service.set_current(9, vehicle.now)
    vehicle.wait_for_all(30)
    assert isinstance(silent.error, MissionTimeout)


def test_set_current_by_command() -> None:
    commands = CommandClient(GROUND, VEHICLE)
    vehicle = ScriptedVehicle(commands)
    setting = commands.begin(set_current_item(3, restart=True), vehicle.now)
    (command,) = vehicle.receive()
    assert (command.command, command.param1, command.param2) == (
        common.MavCmd.DO_SET_MISSION_CURRENT,
        3,
        1,
    )
    ack = common.CommandAck(command=command.command, result=common.MavResult.DENIED, **to_ground())
    vehicle.send(ack)
    assert isinstance(setting.error, CommandDenied)


def test_progress_is_reported_when_it_changes(vehicle, client) -> None:
    current = common.MissionCurrent(seq=1, total=5, mission_state=3, mission_id=7, rally_points_id=8)
    for message in (current, current, common.MissionItemReached(seq=1), common.MissionItemReached(seq=1)):
        vehicle.send(message)
    assert client.events() == [MissionProgress(1, 5, 3, 7, 0, 8), ItemReached(1)]
    vehicle.send(common.MissionCurrent(seq=2, total=5, mission_state=3, mission_id=7, rally_points_id=8))
    vehicle.send(common.MissionItemReached(seq=1))  # PX4 says it again once a second
    assert client.events() == [MissionProgress(2, 5, 3, 7, 0, 8)]
    vehicle.send(common.MissionCurrent(seq=1, total=5, mission_state=3, mission_id=7, rally_points_id=8))
    vehicle.send(common.MissionItemReached(seq=1))
    assert client.events() == [MissionProgress(1, 5, 3, 7, 0, 8), ItemReached(1)]


def test_plan_ids_show_whether_a_plan_is_unchanged(vehicle, client) -> None:
    """0 means that there is no plan or that the vehicle makes no ids: nothing is known."""
    plan = plan_of(2)
    assert client.still_held(plan.with_id(7)) is None
    vehicle.send(common.MissionCurrent(mission_id=7))
    assert client.still_held(plan.with_id(7)) is True
    assert client.still_held(plan.with_id(8)) is False
    assert client.still_held(plan) is None
    assert client.still_held(plan_of(1, PlanType.FENCE).with_id(7)) is None


def test_packets_of_others_are_not_received(vehicle) -> None:
    download, _ = begin(vehicle)
    count = common.MissionCount(count=0, **to_ground())
    vehicle.send(count, source=(2, 1))
    assert not download.done


def test_item_marked_current_is_read(vehicle) -> None:
    download, _ = begin(vehicle)
    vehicle.count(1)
    item = MissionItem(common.MavCmd.NAV_WAYPOINT)
    vehicle.send(item.to_int(GROUND, 0, 0, current=True))
    assert download.result().items[0].current
