from __future__ import annotations

from random import Random

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.setpoints import (
    LocalSetpoint,
    SetpointReceived,
    SetpointReceiver,
    SetpointsTimedOut,
)
from mavstack.services.setpoints.receiver import MAX_SOURCES
from tests.services.network import GROUND, VEHICLE
from tests.services.single_service import deliver, random_message

HERE = LocalSetpoint(position=(1, 2, 3))


def test_setpoints_are_reported_and_kept_with_their_age():
    receiver = SetpointReceiver(VEHICLE)
    deliver(receiver, HERE.to_message(VEHICLE), GROUND, 10.0)
    assert receiver.events() == [SetpointReceived(GROUND, HERE)]
    assert receiver.latest(GROUND, 10.2) == (HERE, 0.1999999999999993)
    assert receiver.latest(Address(7, 7), 10.2) is None


def test_a_stream_below_two_a_second_starves():
    receiver = SetpointReceiver(VEHICLE)
    deliver(receiver, HERE.to_message(VEHICLE), GROUND, 10.0)
    deliver(receiver, HERE.to_message(VEHICLE, 400), GROUND, 10.4)
    receiver.events()
    assert receiver.next_timeout() == 10.9
    receiver.handle_timeout(10.8)
    assert receiver.events() == []
    receiver.handle_timeout(10.9)
    assert receiver.events() == [SetpointsTimedOut(GROUND, HERE)]
    assert receiver.latest(GROUND, 10.9) is None
    assert receiver.next_timeout() is None


def test_impossible_setpoints_are_counted_and_do_not_feed_the_stream():
    receiver = SetpointReceiver(VEHICLE)
    deliver(receiver, HERE.to_message(VEHICLE), GROUND, 10.0)
    deliver(receiver, HERE.to_message(VEHICLE).replace(type_mask=0xFFF), GROUND, 10.3)
    deliver(receiver, HERE.to_message(VEHICLE).replace(coordinate_frame=5), GROUND, 10.3)
    deliver(receiver, HERE.to_message(VEHICLE).replace(x=float("nan")), GROUND, 10.3)
    assert receiver.invalid == 3
    assert "finite" in receiver.last_reason
    receiver.handle_timeout(10.5)
    assert isinstance(receiver.events()[-1], SetpointsTimedOut)


def test_what_was_reordered_on_its_way_is_left_out_and_a_new_clock_is_not():
    receiver = SetpointReceiver(VEHICLE)
    deliver(receiver, HERE.to_message(VEHICLE, 100_000), GROUND, 1.0)
    deliver(receiver, LocalSetpoint(yaw=1.0).to_message(VEHICLE, 99_950), GROUND, 1.1)
    assert receiver.latest(GROUND, 1.1)[0] == HERE
    assert receiver.reordered == 1
    deliver(receiver, LocalSetpoint(yaw=1.0).to_message(VEHICLE, 50), GROUND, 1.2)
    assert receiver.latest(GROUND, 1.2)[0] == LocalSetpoint(yaw=1.0)


def test_a_flood_of_sources_is_bounded_and_does_not_push_out_the_first():
    receiver = SetpointReceiver(VEHICLE)
    for number in range(1, MAX_SOURCES + 50):
        deliver(receiver, HERE.to_message(VEHICLE), Address(number % 250 + 1, number // 250 + 1), 1.0)
    assert len(receiver.sources) == MAX_SOURCES
    assert receiver.refused_sources == 49
    assert Address(2, 1) in receiver.sources


def test_garbage_from_the_wire_never_raises():
    receiver = SetpointReceiver(VEHICLE)
    random = Random(3)
    kinds = (common.SetPositionTargetLocalNed, common.SetPositionTargetGlobalInt, common.SetAttitudeTarget)
    for number in range(3000):
        deliver(receiver, random_message(random.choice(kinds), random), GROUND, number / 100)
    assert receiver.invalid > 0
