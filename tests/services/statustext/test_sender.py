from __future__ import annotations

from mavstack.dialects import common
from mavstack.services import BROADCAST, Priority
from mavstack.services.statustext import StatustextSender
from tests.services.network import START, VEHICLE
from tests.services.single_service import sent_by


def test_texts_go_to_all_in_order_with_ids_of_their_own() -> None:
    sender = StatustextSender(VEHICLE)
    for text in ("x" * 60, "short", "y" * 60):
        sender.send_text(text, common.MavSeverity.WARNING)
    sent = list(sender.messages_to_send(START))
    assert {outgoing.target for outgoing in sent} == {BROADCAST}
    assert [outgoing.message.id for outgoing in sent] == [1, 1, 0, 2, 2]
    assert {outgoing.message.severity for outgoing in sent} == {common.MavSeverity.WARNING}


def test_on_a_full_link_texts_wait() -> None:
    sender = StatustextSender(VEHICLE)
    sender.send_text("x" * 120)
    room = iter([True, True, False])

    def has_room(target, priority=Priority.BULK) -> bool:
        assert priority == Priority.STREAM
        return next(room)

    assert len(list(sender.messages_to_send(START, has_room))) == 2
    assert [message.chunk_seq for message in sent_by(sender)] == [2]


def test_of_too_many_the_oldest_is_dropped_whole() -> None:
    sender = StatustextSender(VEHICLE)
    for number in range(70):
        sender.send_text(f"{number}" + "x" * 60)
    sent = sent_by(sender)
    assert sender.dropped == 6
    assert len(sent) == 2 * 64
    assert sent[0].text.startswith("6x")
