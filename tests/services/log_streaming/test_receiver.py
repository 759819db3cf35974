"""The receiver acknowledges what asks for it, and reports gaps."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services.log_streaming import LogStreamData, LogStreamGap, LogStreamReceiver
from tests.services.log_streaming.test_assembler import HEADER, blocks_of, message
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, feed_random_messages, sent_by


def block_message(kind, block):
    sequence, data, first = block
    return kind(sequence=sequence, data=data, length=len(data), first_message_offset=first)


def test_a_repeated_block_is_acknowledged_again():
    receiver = LogStreamReceiver(GROUND, VEHICLE)
    for _ in range(2):
        deliver(receiver, block_message(common.LoggingDataAcked, (0, HEADER, 255)), VEHICLE, START)
        assert sent_by(receiver) == [common.LoggingAck(*VEHICLE, 0)]
    assert receiver.events() == [LogStreamData(HEADER)]
    assert receiver.blocks == 1


def test_a_gap_is_reported():
    receiver = LogStreamReceiver(GROUND, VEHICLE)
    log = HEADER + b"".join(message(bytes([number]) * 100) for number in range(20))
    blocks = blocks_of(log)
    for block in blocks[:2] + blocks[4:]:
        deliver(receiver, block_message(common.LoggingData, block), VEHICLE, START)
    assert sent_by(receiver) == []
    assert [event for event in receiver.events() if isinstance(event, LogStreamGap)] == [
        LogStreamGap(2, 16 + 103 * 4)
    ]
    assert (receiver.lost, receiver.blocks) == (2, len(blocks) - 2)


def test_random_messages():
    feed_random_messages(
        LogStreamReceiver(GROUND, VEHICLE), [common.LoggingData, common.LoggingDataAcked], seed=1
    )
