from __future__ import annotations

from random import Random

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.manual_control import (
    RELEASE,
    ChannelOverride,
    ManualControlReceiver,
    ManualInput,
    ManualInputLost,
    ManualInputReceived,
    OverrideLost,
    OverrideReceived,
)
from mavstack.services.manual_control.receiver import MAX_SOURCES
from tests.services.network import GROUND, VEHICLE
from tests.services.single_service import deliver, random_message

OTHER = Address(250, 190)


def override(channels):
    return ChannelOverride(channels).to_message(VEHICLE)


def test_each_source_has_its_own_input_and_its_own_end():
    receiver = ManualControlReceiver(VEHICLE)
    deliver(receiver, ManualInput(x=1).to_message(1), GROUND, 10.0)
    deliver(receiver, ManualInput(x=2).to_message(1), OTHER, 10.5)
    assert receiver.latest(GROUND, 10.75) == (ManualInput(x=1), 0.75)
    receiver.events()
    receiver.handle_timeout(11.0)
    assert receiver.events() == [ManualInputLost(GROUND)]
    assert receiver.latest(GROUND, 11.0) is None
    assert receiver.latest(OTHER, 11.0) == (ManualInput(x=2), 0.5)
    assert receiver.next_timeout() == 11.5


def test_sticks_for_another_system_are_not_ours():
    receiver = ManualControlReceiver(VEHICLE)
    deliver(receiver, ManualInput(x=1).to_message(2), GROUND, 10.0)
    assert receiver.events() == []
    deliver(receiver, ManualInput(x=1).to_message(0), GROUND, 10.0)
    assert receiver.events() == [ManualInputReceived(GROUND, ManualInput(x=1))]


def test_overrides_add_up_until_they_are_released():
    receiver = ManualControlReceiver(VEHICLE)
    deliver(receiver, override({1: 1500, 9: 1600}), GROUND, 10.0)
    deliver(receiver, override({2: 1400}), GROUND, 11.0, 1)
    assert receiver.overridden(GROUND, 11.0) == ({1: 1500, 9: 1600, 2: 1400}, 0.0)
    deliver(receiver, override({1: RELEASE, 9: RELEASE}), GROUND, 11.5, 2)
    assert receiver.overridden(GROUND, 11.5)[0] == {2: 1400}
    deliver(receiver, override({2: RELEASE}), GROUND, 11.6, 3)
    assert receiver.overridden(GROUND, 11.6) is None
    assert receiver.events()[-1] == OverrideReceived(GROUND, {})
    receiver.handle_timeout(20.0)
    assert receiver.events() == []  # what was given back is not lost


def test_an_override_that_is_not_repeated_is_lost():
    receiver = ManualControlReceiver(VEHICLE)
    deliver(receiver, override({1: 1500}), GROUND, 10.0)
    receiver.events()
    receiver.handle_timeout(13.0)
    assert receiver.events() == [OverrideLost(GROUND)]
    deliver(receiver, override({2: 1400}), GROUND, 14.0)
    assert receiver.overridden(GROUND, 14.0)[0] == {2: 1400}


def test_an_reordered_packet_does_not_take_hold_again_after_the_release():
    receiver = ManualControlReceiver(VEHICLE)
    deliver(receiver, override({1: 1500}), GROUND, 10.0, 254)
    deliver(receiver, override({1: RELEASE}), GROUND, 10.2, 1)
    deliver(receiver, override({1: 1500}), GROUND, 10.3, 255)
    assert receiver.overridden(GROUND, 10.3) is None
    assert receiver.reordered == 1


def test_a_sender_that_restarts_is_received_after_a_moment():
    receiver = ManualControlReceiver(VEHICLE)
    deliver(receiver, ManualInput(x=1).to_message(1), GROUND, 10.0, 30)
    deliver(receiver, ManualInput(x=2).to_message(1), GROUND, 10.1, 0)
    deliver(receiver, ManualInput(x=3).to_message(1), GROUND, 10.6, 1)
    assert receiver.latest(GROUND, 10.6)[0] == ManualInput(x=3)


def test_a_flood_of_sources_is_bounded_and_does_not_push_out_the_pilot():
    receiver = ManualControlReceiver(VEHICLE)
    deliver(receiver, ManualInput(x=1).to_message(1), GROUND, 1.0)
    for number in range(1, 100):
        deliver(receiver, ManualInput(x=2).to_message(1), Address(number, 7), 1.0)
        deliver(receiver, override({1: 1500}), Address(number, 7), 1.0)
    assert receiver.latest(GROUND, 1.0)[0] == ManualInput(x=1)
    assert receiver.refused_sources == (100 - MAX_SOURCES) + (99 - MAX_SOURCES)


def test_garbage_from_the_wire_never_raises():
    receiver = ManualControlReceiver(VEHICLE)
    random = Random(4)
    for number in range(2000):
        kind = random.choice([common.ManualControl, common.RcChannelsOverride])
        message = random_message(kind, random)
        deliver(receiver, message, GROUND, number / 10, random.randrange(256))
        receiver.handle_timeout(number / 10)
    for event in receiver.events():
        if isinstance(event, ManualInputReceived):
            event.input.check()
