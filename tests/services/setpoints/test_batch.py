"""A batch sends each message once, to its vehicle, and keeps none of an older step."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.service import Priority
from mavstack.services.setpoints.batch import SetpointBatch
from tests.services.network import GROUND

FIRST, SECOND = Address(1, 1), Address(2, 1)


def message(target, north):
    return common.SetPositionTargetLocalNed(target_system=target.system, vx=north)


def test_each_message_is_sent_once_to_its_vehicle():
    batch = SetpointBatch(GROUND)
    batch.set([(message(FIRST, 1.0), FIRST), (message(SECOND, 2.0), SECOND)])
    sent = list(batch.messages_to_send(0.0))
    assert [(each.target, each.message.vx) for each in sent] == [(FIRST, 1.0), (SECOND, 2.0)]
    assert {each.priority for each in sent} == {Priority.STREAM}
    assert list(batch.messages_to_send(0.1)) == []
    assert batch.next_timeout() is None


def test_a_newer_step_replaces_what_was_not_sent():
    batch = SetpointBatch(GROUND)
    batch.set([(message(FIRST, 1.0), FIRST)])
    batch.set([(message(FIRST, 3.0), FIRST)])
    assert [each.message.vx for each in batch.messages_to_send(0.0)] == [3.0]
