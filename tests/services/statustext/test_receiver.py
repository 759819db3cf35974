from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.statustext import GAP, StatusText, StatustextReceiver, chunks_of
from mavstack.wire import Parser, encode
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import feed_random_messages, packet_of

A, B, C = "a" * 50, "b" * 50, "c" * 20


class ReceiverHarness:
    def __init__(self) -> None:
        self.receiver = StatustextReceiver(GROUND)
        self.sequence = 0

    def receive(self, *messages: common.Statustext, source: Address = VEHICLE, now: float = START) -> None:
        for message in messages:
            self.receiver.receive(packet_of(message, source, self.sequence % 256), now)
            self.sequence += 1

    def received_texts(self, now: float | None = None) -> list[str]:
        if now is not None:
            self.receiver.handle_timeout(now)
        return [event.text for event in self.receiver.events()]


def long(number: int = 5, text: str = A + B + C, severity: int = 6) -> list[common.Statustext]:
    return chunks_of(text, severity, number)


def test_id_0_is_reported_at_once() -> None:
    harness = ReceiverHarness()
    harness.receive(common.Statustext(severity=3, text="PreArm: GPS"))
    assert harness.receiver.events() == [StatusText(VEHICLE, 3, "PreArm: GPS")]


def test_chunks_make_one_text() -> None:
    harness = ReceiverHarness()
    harness.receive(*long()[:2])
    assert harness.received_texts() == []
    harness.receive(long()[2])
    assert harness.receiver.events() == [StatusText(VEHICLE, 6, A + B + C)]
    assert harness.receiver.next_timeout() is None


def test_a_tab_at_the_end_stands_for_an_event() -> None:
    harness = ReceiverHarness()
    harness.receive(common.Statustext(severity=6, text="Armed by stick gesture\t"), *long(5, f"{A}\t"))
    texts = [StatusText(VEHICLE, 6, "Armed by stick gesture", has_event=True)]
    assert harness.receiver.events() == [*texts, StatusText(VEHICLE, 6, A, has_event=True)]


def test_a_nul_ends_a_text_and_what_follows_it_is_junk() -> None:
    harness = ReceiverHarness()
    harness.receive(common.Statustext(severity=6, text=b"end\0junk", id=5, chunk_seq=0))
    assert harness.received_texts() == ["end"]


@pytest.mark.parametrize(
    ("lost", "text"),
    [(0, GAP + B + C), (1, A + GAP + C), (2, A + B + GAP)],
)
def test_a_gap_times_out_and_is_marked(lost: int, text: str) -> None:
    harness = ReceiverHarness()
    chunks = long()
    del chunks[lost]
    harness.receive(*chunks)
    assert harness.received_texts(START + 1) == []
    harness.receiver.handle_timeout(harness.receiver.next_timeout())
    (event,) = harness.receiver.events()
    assert (event.text, event.complete) == (text, False)
    assert harness.receiver.next_timeout() is None


def test_a_chunk_that_comes_after_its_text_was_reported_is_no_text_of_its_own() -> None:
    harness = ReceiverHarness()
    chunks = long()
    harness.receive(chunks[0], chunks[2])
    assert len(harness.received_texts(START + 3)) == 1
    harness.receive(chunks[1], now=START + 3.5)
    assert harness.received_texts(START + 60) == []


def test_components_and_systems_are_reported_apart() -> None:
    harness = ReceiverHarness()
    other, third = Address(1, 100), Address(2, 1)
    for chunk in range(3):
        for source, text in ((VEHICLE, A + B + C), (other, B + C + A), (third, C + C + C)):
            harness.receive(*long(5, text)[chunk : chunk + 1], source=source)
    assert sorted(harness.received_texts()) == sorted([A + B + C, B + C + A, C + C + C])


def test_duplicates_are_reported_once() -> None:
    harness = ReceiverHarness()
    harness.receive(*long(), *long(), *reversed(long()))
    assert harness.received_texts(START + 4) == [A + B + C]
    packet = packet_of(common.Statustext(severity=6, text="hello"), sequence=9)
    for _ in range(3):
        harness.receiver.receive(packet, START)
    assert harness.received_texts() == ["hello"]


def test_a_text_sent_twice_is_reported_twice() -> None:
    harness = ReceiverHarness()
    for number in (5, 6):
        harness.receive(common.Statustext(severity=6, text="hello"), *long(number))
    assert harness.received_texts() == ["hello", A + B + C] * 2


def test_a_sender_that_starts_again_uses_its_ids_again() -> None:
    harness = ReceiverHarness()
    harness.receive(*long(1))
    harness.receive(*long(1, C + A + B), now=START + 0.5)
    assert harness.received_texts() == [A + B + C, C + A + B]
    harness.receive(long(2)[0])
    harness.receive(*long(2, B + B + C), now=START + 1)
    assert harness.received_texts() == [A + GAP, B + B + C]


def test_an_id_may_be_used_again_later() -> None:
    harness = ReceiverHarness()
    harness.receive(*long(1))
    harness.receive(*long(1), now=START + 60)
    assert harness.received_texts() == [A + B + C] * 2


def test_mavlink_1_has_no_ids() -> None:
    receiver = StatustextReceiver(GROUND)
    data = encode(common.Statustext(text="old", severity=1), system=1, component=1, sequence=0, version=1)
    (packet,) = Parser(common).feed(data)
    receiver.receive(packet, START)
    assert receiver.events() == [StatusText(VEHICLE, 1, "old")]


def test_the_table_is_bounded_and_nothing_is_lost_silently() -> None:
    harness = ReceiverHarness()
    for number in range(1, 501):
        harness.receive(long(number)[0])
    received_texts = harness.received_texts()
    assert len(received_texts) == 500 - 64
    assert set(received_texts) == {A + GAP}
    assert len(harness.received_texts(START + 10)) == 64


@pytest.mark.parametrize("seed", range(50))
def test_garbage_never_raises(seed: int) -> None:
    feed_random_messages(StatustextReceiver(GROUND), [common.Statustext], seed)
