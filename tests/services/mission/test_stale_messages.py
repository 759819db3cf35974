"""Stale messages of an ended transfer do not affect the next one."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionClient, PlanType
from mavstack.services.mission.stale_messages import QUIET, SETTLE, UPLOAD_EXPIRES_AFTER
from tests.services.mission.scripted_peer import ScriptedVehicle, kinds, plan_of
from tests.services.network import GROUND, VEHICLE

Result = common.MavMissionResult


@pytest.fixture
def vehicle() -> ScriptedVehicle:
    return ScriptedVehicle(MissionClient(GROUND, VEHICLE))


def cancelled_upload(vehicle: ScriptedVehicle) -> None:
    client = vehicle.service
    upload = client.upload(plan_of(3), vehicle.now)
    vehicle.request(0)
    client.cancel(upload, vehicle.now)
    assert kinds(vehicle.receive())[-1] == "MissionAck"


def seconds_until_count(vehicle: ScriptedVehicle) -> float:
    begin = vehicle.now
    while "MissionCount" not in kinds(vehicle.wait()):
        pass
    return vehicle.now - begin


def test_upload_after_a_cancelled_one_waits_until_the_vehicle_is_quiet(vehicle) -> None:
    """Its count may be lost, and the vehicle would take its items for those of the other."""
    cancelled_upload(vehicle)
    vehicle.service.upload(plan_of(3, speed=1.0), vehicle.now)
    assert vehicle.receive() == []
    assert seconds_until_count(vehicle) == pytest.approx(QUIET)


def test_vehicle_that_does_not_know_cancelling_is_waited_for(vehicle) -> None:
    """ArduPilot goes on asking until it gives up."""
    cancelled_upload(vehicle)
    begin = vehicle.now
    second = vehicle.service.upload(plan_of(3, speed=1.0), vehicle.now)
    for _ in range(8):
        vehicle.wait(1.0)
        assert "MissionItemInt" not in kinds(vehicle.request(1))
    assert seconds_until_count(vehicle) + 8 == pytest.approx(UPLOAD_EXPIRES_AFTER)
    assert vehicle.now == pytest.approx(begin + UPLOAD_EXPIRES_AFTER)
    assert not second.done


def test_vehicle_that_confirms_need_not_be_waited_for(vehicle) -> None:
    cancelled_upload(vehicle)
    vehicle.service.upload(plan_of(3, speed=1.0), vehicle.now)
    assert vehicle.ack(Result.OPERATION_CANCELLED) == []
    assert seconds_until_count(vehicle) <= SETTLE


def test_plans_of_other_types_do_not_wait(vehicle) -> None:
    cancelled_upload(vehicle)
    vehicle.service.upload(plan_of(3, PlanType.FENCE), vehicle.now)
    assert kinds(vehicle.receive()) == ["MissionCount"]


def test_request_of_another_upload_is_not_served(vehicle) -> None:
    """A vehicle that has heard our count asks for item 0 first."""
    vehicle.service.upload(plan_of(3), vehicle.now)
    assert kinds(vehicle.receive()) == ["MissionCount"]
    assert vehicle.request(1) == []
    assert kinds(vehicle.request(0)) == ["MissionItemInt"]
    assert kinds(vehicle.request(2)) == ["MissionItemInt"]


def test_vehicle_in_another_upload_is_reported_to_leave_it(vehicle) -> None:
    """PX4 answers ERROR to a count while it waits for a later item."""
    upload = vehicle.service.upload(plan_of(1), vehicle.now)
    vehicle.receive()
    (ack,) = vehicle.ack(Result.ERROR)
    assert ack.type == Result.OPERATION_CANCELLED
    assert kinds(vehicle.wait()) == ["MissionCount"]
    vehicle.request(0)
    vehicle.ack(Result.ACCEPTED)
    assert upload.error is None


def test_first_answer_after_a_failure_is_passed_over(vehicle) -> None:
    """The link may have held it back since long before."""
    failed = vehicle.service.download(vehicle.now)
    vehicle.wait_for_all(30)
    assert failed.done
    download = vehicle.service.download(vehicle.now)
    vehicle.receive()
    assert vehicle.count(0) == []
    assert vehicle.count(0) == []
    assert kinds(vehicle.wait()) == ["MissionRequestList"]
    vehicle.count(1)
    vehicle.item(plan_of(1), 0)
    assert download.result() == plan_of(1)


def test_vehicle_that_begins_by_a_late_count_is_stopped_and_waited_for(vehicle) -> None:
    vehicle.service.upload(plan_of(1), vehicle.now)
    vehicle.request(0)
    vehicle.ack(Result.ACCEPTED)
    vehicle.service.upload(plan_of(3), vehicle.now)
    (ack,) = vehicle.request(0)
    assert ack.type == Result.OPERATION_CANCELLED
    assert seconds_until_count(vehicle) == pytest.approx(QUIET)


def test_reading_back_after_an_upload_does_not_wait(vehicle) -> None:
    vehicle.service.upload(plan_of(1), vehicle.now)
    vehicle.request(0)
    vehicle.ack(Result.ACCEPTED)
    vehicle.service.download(vehicle.now)
    assert kinds(vehicle.receive()) == ["MissionRequestList"]
