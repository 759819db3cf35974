"""Uploads, against a vehicle controlled by the test."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, MissionDenied, MissionTimeout, RemoteCancelled
from mavstack.services import OperationEnded, Progress
from mavstack.services.mission import MissionClient, MissionItem, Plan, PlanType
from tests.services.mission.scripted_peer import ScriptedVehicle, kinds, plan_of, seqs, to_ground, waypoints
from tests.services.network import GROUND, VEHICLE

Result = common.MavMissionResult


@pytest.fixture
def client() -> MissionClient:
    return MissionClient(GROUND, VEHICLE)


@pytest.fixture
def vehicle(client) -> ScriptedVehicle:
    return ScriptedVehicle(client)


def begin(vehicle: ScriptedVehicle, plan: Plan, **options):
    upload = vehicle.service.upload(plan, vehicle.now, **options)
    return upload, vehicle.receive()


def test_items_go_up_one_by_one_and_the_id_comes_back(vehicle, client) -> None:
    plan = plan_of(3)
    upload, received = begin(vehicle, plan)
    assert [(kinds(received), received[0].count, received[0].mission_type)] == [(["MissionCount"], 3, 0)]
    for seq in range(3):
        (item,) = vehicle.request(seq)
        assert isinstance(item, common.MissionItemInt)
        assert item.seq == seq
        assert MissionItem.read(item) == plan.items[seq]
    assert vehicle.ack(Result.ACCEPTED, plan_id=77) == []
    assert upload.result() == plan
    assert upload.result().plan_id == 77
    events = client.events()
    assert [(event.done, event.total) for event in events if isinstance(event, Progress)][-1] == (3, 3)
    assert isinstance(events[-1], OperationEnded)


def test_message_type_of_each_plan_type_is_kept_apart(vehicle) -> None:
    upload, received = begin(vehicle, plan_of(1, PlanType.RALLY))
    assert received[0].mission_type == PlanType.RALLY
    assert vehicle.request(0, PlanType.FENCE) == []
    (item,) = vehicle.request(0, PlanType.RALLY)
    assert item.mission_type == PlanType.RALLY
    vehicle.ack(Result.ACCEPTED, PlanType.MISSION)
    assert not upload.done
    vehicle.ack(Result.ACCEPTED, PlanType.RALLY)
    assert upload.result().type == PlanType.RALLY


def test_mission_request_is_answered_with_integers_too(vehicle) -> None:
    begin(vehicle, plan_of(1))
    received = vehicle.send(common.MissionRequest(seq=0, **to_ground()))
    assert kinds(received) == ["MissionItemInt"]


def test_old_vehicle_that_refuses_integers_gets_floats(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(2))
    assert kinds(vehicle.send(common.MissionRequest(seq=0, **to_ground()))) == ["MissionItemInt"]
    assert kinds(vehicle.ack(Result.UNSUPPORTED)) == ["MissionItem"]
    assert kinds(vehicle.send(common.MissionRequest(seq=1, **to_ground()))) == ["MissionItem"]
    vehicle.ack(Result.UNSUPPORTED)
    with pytest.raises(MissionDenied):
        upload.result()


def test_out_of_sequence_request_is_served_and_no_error(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(5))
    for seq in (0, 1, 2, 0, 4, 3, 4):
        vehicle.now += 1.0
        assert seqs(vehicle.request(seq)) == [seq]
    assert vehicle.request(5) == []
    vehicle.ack(Result.ACCEPTED)
    assert upload.error is None


def test_silence_brings_the_due_item_and_the_next_again_after_a_round_trip(vehicle) -> None:
    """Not after the second or more that vehicles take to ask again."""
    begin(vehicle, plan_of(10))
    for seq in range(5):
        vehicle.now += 0.04
        vehicle.request(seq)
    before = vehicle.now
    assert seqs(vehicle.wait()) == [4, 5]
    assert vehicle.now - before < 0.1
    # The next request may have been made before that item came: it is not sent a third time.
    vehicle.now += 0.02
    assert vehicle.request(5) == []
    assert seqs(vehicle.wait()) == [5, 6]
    vehicle.now += 0.04
    assert seqs(vehicle.request(7)) == [7]


def test_count_is_sent_again(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(1))
    assert kinds(vehicle.wait_for_all(5)).count("MissionCount") >= 3
    vehicle.wait_for_all(10)
    with pytest.raises(
        MissionTimeout, match=r"uploading the mission to 1/1 failed after .* attempts: no answer"
    ):
        upload.result()


def test_invalid_sequence_does_not_end_the_upload(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(3))
    vehicle.request(0)
    for _ in range(5):
        assert vehicle.ack(Result.INVALID_SEQUENCE) == []
    for seq in (1, 2):
        vehicle.now += 1
        vehicle.request(seq)
    vehicle.ack(Result.ACCEPTED)
    assert upload.error is None


def test_early_acceptance_is_not_believed(vehicle) -> None:
    """It can only be a late one, of another upload."""
    upload, _ = begin(vehicle, plan_of(3))
    vehicle.ack(Result.ACCEPTED)
    vehicle.request(0)
    vehicle.request(1)
    vehicle.ack(Result.ACCEPTED)
    assert not upload.done


def test_a_refusal_has_its_code_and_item(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(3))
    vehicle.request(0)
    vehicle.request(1)
    vehicle.ack(Result.INVALID_PARAM2)
    with pytest.raises(MissionDenied, match="INVALID_PARAM2 at item 1") as caught:
        upload.result()
    assert (caught.value.code, caught.value.item) == (Result.INVALID_PARAM2, 1)


@pytest.mark.parametrize("code", [Result.NO_SPACE, Result.DENIED, Result.UNSUPPORTED, 99])
def test_count_can_be_denied(vehicle, code) -> None:
    upload, _ = begin(vehicle, plan_of(3))
    vehicle.ack(code)
    with pytest.raises(MissionDenied) as caught:
        upload.result()
    assert (caught.value.code, caught.value.item) == (code, None)


def test_error_to_the_count_is_believed_the_third_time(vehicle) -> None:
    """PX4 says so while it is in another transfer, even of ours."""
    upload, _ = begin(vehicle, plan_of(3))
    for _ in range(2):
        (ack,) = vehicle.ack(Result.ERROR)
        assert ack.type == Result.OPERATION_CANCELLED
        assert kinds(vehicle.wait()) == ["MissionCount"]
    vehicle.ack(Result.ERROR)
    with pytest.raises(MissionDenied):
        upload.result()


def test_error_about_a_late_copy_does_not_end_a_living_upload(vehicle) -> None:
    """PX4 says ERROR to a second count when items have come, and goes on."""
    upload, _ = begin(vehicle, plan_of(3))
    vehicle.request(0)
    vehicle.now += 0.1
    vehicle.request(1)
    assert seqs(vehicle.ack(Result.ERROR)) == [1]
    vehicle.now += 0.1
    assert seqs(vehicle.request(2)) == [2]
    vehicle.ack(Result.ACCEPTED)
    assert upload.error is None


def test_denial_of_something_late_does_not_end_a_living_upload(vehicle) -> None:
    """ArduPilot says DENIED to a late request for a list, and goes on."""
    upload, _ = begin(vehicle, plan_of(3))
    vehicle.request(0)
    vehicle.now += 0.1
    vehicle.request(1)
    assert seqs(vehicle.ack(Result.DENIED)) == [1]
    vehicle.now += 0.1
    assert seqs(vehicle.request(2)) == [2]
    vehicle.ack(Result.DENIED)
    with pytest.raises(MissionDenied):
        upload.result()


def test_vehicle_that_forgot_the_upload_is_begun_with_again(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(3))
    vehicle.request(0)
    vehicle.ack(Result.ERROR)
    assert kinds(vehicle.ack(Result.ERROR)) == ["MissionCount"]
    for seq in range(3):
        vehicle.now += 1
        vehicle.request(seq)
    vehicle.ack(Result.ACCEPTED)
    assert upload.error is None


def test_vehicle_that_always_errs_is_believed_in_the_end(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(3))
    for _ in range(5):
        assert seqs(vehicle.request(0)) == [0]
        assert seqs(vehicle.ack(Result.ERROR)) == [0]
        vehicle.ack(Result.ERROR)
    with pytest.raises(MissionDenied) as caught:
        upload.result()
    assert caught.value.code == Result.ERROR


def all_sent(vehicle: ScriptedVehicle, plan: Plan, **options):
    upload, _ = begin(vehicle, plan, **options)
    for seq in range(len(plan)):
        vehicle.now += 0.04
        vehicle.request(seq)
    return upload


def test_lost_final_ack_is_requested_by_the_last_item(vehicle) -> None:
    """PX4 then says it again."""
    upload = all_sent(vehicle, plan_of(3))
    assert seqs(vehicle.wait()) == [2]
    vehicle.ack(Result.ACCEPTED, plan_id=5)
    assert upload.result().plan_id == 5


def read_back(vehicle: ScriptedVehicle, held: Plan) -> list:
    vehicle.count(len(held), plan_id=9)
    for seq in range(len(held)):
        received = vehicle.item(held, seq)
    return received


def test_lost_final_ack_is_verified_by_reading_back(vehicle) -> None:
    """ArduPilot says ERROR to an item after its upload has ended."""
    plan = plan_of(3)
    upload = all_sent(vehicle, plan)
    assert kinds(vehicle.ack(Result.ERROR)) == ["MissionRequestList"]
    assert not upload.done
    received = read_back(vehicle, plan)
    assert [(type(message), message.type) for message in received] == [(common.MissionAck, Result.ACCEPTED)]
    assert upload.result() == plan
    assert upload.result().plan_id == 9


def test_silence_after_the_last_item_is_verified_too(vehicle) -> None:
    upload = all_sent(vehicle, plan_of(3))
    received = vehicle.wait_for_all(5.0)
    assert "MissionRequestList" in kinds(received)
    read_back(vehicle, plan_of(3))
    assert upload.error is None


def test_vehicle_that_holds_something_else_gets_the_plan_again(vehicle) -> None:
    upload = all_sent(vehicle, plan_of(3))
    vehicle.ack(Result.ERROR)
    received = read_back(vehicle, plan_of(3, speed=1.0))
    assert kinds(received) == ["MissionAck", "MissionCount"]
    assert not upload.done


def test_home_takes_the_place_of_the_first_item_where_it_does() -> None:
    sent, home = waypoints(3), MissionItem(common.MavCmd.NAV_WAYPOINT, param5=1.0)
    for home_first, ends in ((True, True), (False, False)):
        vehicle = ScriptedVehicle(MissionClient(GROUND, VEHICLE, home_first=home_first))
        upload = all_sent(vehicle, Plan.of(sent))
        vehicle.ack(Result.ERROR)
        read_back(vehicle, Plan.of([home, *sent[1:]]))
        assert upload.done is ends


def test_when_nothing_can_be_learned_nothing_is_claimed(vehicle) -> None:
    upload = all_sent(vehicle, plan_of(3))
    vehicle.wait_for_all(60)
    with pytest.raises(MissionTimeout, match="the vehicle did not confirm them"):
        upload.result()


def test_cancelling_is_sent_to_the_vehicle(vehicle, client) -> None:
    upload, _ = begin(vehicle, plan_of(3))
    vehicle.request(0)
    client.cancel(upload, vehicle.now)
    (ack,) = vehicle.receive()
    assert (type(ack), ack.type) == (common.MissionAck, Result.OPERATION_CANCELLED)
    with pytest.raises(RemoteCancelled):
        upload.result()
    # If that acknowledgement was lost, the vehicle requests again and receives it again.
    (ack,) = vehicle.request(1)
    assert ack.type == Result.OPERATION_CANCELLED
    vehicle.now += 60
    assert vehicle.request(1) == []


def test_a_timeout_is_sent_to_the_vehicle(vehicle) -> None:
    begin(vehicle, plan_of(3))
    vehicle.request(0)
    received = vehicle.wait_for_all(30)
    assert (type(received[-1]), received[-1].type) == (common.MissionAck, Result.OPERATION_CANCELLED)


def test_vehicle_can_cancel(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(3))
    vehicle.request(0)
    vehicle.ack(Result.OPERATION_CANCELLED)
    with pytest.raises(RemoteCancelled, match="OPERATION_CANCELLED"):
        upload.result()


def test_vehicle_that_asks_for_one_item_for_ever_does_not_hold_us(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(3))
    for _ in range(100):
        vehicle.request(0)
        vehicle.wait(0.2)
    assert isinstance(upload.error, MissionTimeout)


def test_limit_holds_even_if_it_moves(vehicle) -> None:
    upload, _ = begin(vehicle, plan_of(500), timeout=5.0)
    for seq in range(60):
        vehicle.request(seq)
        vehicle.wait(0.1)
    assert isinstance(upload.error, MissionTimeout)


def test_empty_plan_needs_no_items(vehicle) -> None:
    upload, received = begin(vehicle, plan_of(0))
    assert received[0].count == 0
    vehicle.ack(Result.ACCEPTED)
    assert upload.result() == plan_of(0)


def test_one_transfer_at_a_time(vehicle, client) -> None:
    """PX4 has one state for all types."""
    first, received = begin(vehicle, plan_of(1))
    second, more = begin(vehicle, plan_of(1, PlanType.FENCE))
    assert (kinds(received), more) == (["MissionCount"], [])
    vehicle.request(0)
    (count,) = vehicle.ack(Result.ACCEPTED)
    assert count.mission_type == PlanType.FENCE
    assert first.done
    assert not second.done


def test_next_upload_of_the_type_waits_until_late_packets_are_gone(vehicle) -> None:
    begin(vehicle, plan_of(1))
    vehicle.request(0)
    vehicle.ack(Result.ACCEPTED)
    second, received = begin(vehicle, plan_of(1, speed=1.0))
    assert received == []
    vehicle.ack(Result.ACCEPTED)
    assert not second.done
    assert kinds(vehicle.wait()) == ["MissionCount"]
    assert vehicle.now > 0.3


def test_what_is_no_plan_is_refused_at_once(client) -> None:
    for plan in (Plan.of([], PlanType.ALL), Plan.of([], 7), Plan.of(waypoints(1) * 65536)):
        with pytest.raises(InvalidArgumentError):
            client.upload(plan, 0.0)


def test_ardupilot_refuses_an_item_that_it_does_not_support(vehicle) -> None:
    """It requests by MISSION_REQUEST, and after the refusal answers every item with ERROR."""
    plan = Plan.of(
        [*waypoints(3), MissionItem(common.MavCmd.DO_ORBIT, param5=47.0, param6=8.0), *waypoints(2)]
    )
    upload, _ = begin(vehicle, plan)
    for seq in range(4):
        vehicle.now += 0.05
        vehicle.send(common.MissionRequest(seq=seq, **to_ground()))
    assert kinds(vehicle.ack(Result.UNSUPPORTED)) == ["MissionItem"]
    vehicle.ack(Result.ERROR)
    vehicle.ack(Result.ERROR)
    refusal = r"UNSUPPORTED at item 3 \(DO_ORBIT in frame GLOBAL_RELATIVE_ALT\)"
    with pytest.raises(MissionDenied, match=refusal) as caught:
        upload.result()
    assert (caught.value.item, caught.value.code) == (3, Result.UNSUPPORTED)


@pytest.mark.parametrize("first", [Result.UNSUPPORTED, Result.DENIED])
def test_a_refusal_is_not_forgotten_when_the_vehicle_falls_silent(vehicle, first) -> None:
    upload, _ = begin(vehicle, plan_of(4))
    for seq in range(2):
        vehicle.now += 0.05
        vehicle.send(common.MissionRequest(seq=seq, **to_ground()))
    vehicle.ack(first)
    vehicle.wait_for_all(15)
    with pytest.raises(MissionDenied, match=rf"{first.name} at item 1 \(NAV_WAYPOINT in frame"):
        upload.result()
