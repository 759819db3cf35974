from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.services.statustext import StatusText, StatustextReceiver, chunks_of
from mavstack.services.statustext.chunks import MAX_LENGTH, next_number
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import packet_of

if TYPE_CHECKING:
    from mavstack.dialects import common


def raw(message: common.Statustext) -> bytes:
    return message.to_payload()[1:51].ljust(50, b"\0")


@pytest.mark.parametrize("length", [0, 1, 49, 50])
def test_a_short_text_is_one_message_with_id_0(length: int) -> None:
    (message,) = chunks_of("x" * length, 4, 9)
    assert (message.id, message.chunk_seq, message.severity) == (0, 0, 4)
    assert message.text == "x" * length


@pytest.mark.parametrize(("length", "chunks"), [(51, 2), (99, 2), (100, 3), (101, 3), (MAX_LENGTH, 256)])
def test_a_long_text_ends_with_a_nul(length: int, chunks: int) -> None:
    messages = chunks_of("x" * length, 4, 9)
    assert [message.chunk_seq for message in messages] == list(range(chunks))
    assert {message.id for message in messages} == {9}
    assert all(b"\0" not in raw(message) for message in messages[:-1])
    assert raw(messages[-1]).endswith(b"\0")


def test_a_character_may_be_cut_in_two() -> None:
    messages = chunks_of("x" * 49 + "é" + "y" * 10, 4, 9)
    assert raw(messages[0])[-1] == "é".encode()[0]


def test_a_text_that_no_chunks_can_hold_is_our_own_mistake() -> None:
    with pytest.raises(InvalidArgumentError):
        chunks_of("x" * (MAX_LENGTH + 1), 4, 9)


def test_ids_increase_and_skip_0() -> None:
    assert next_number(0) == 1
    assert next_number(7) == 8
    assert next_number(0xFFFF) == 1


@given(st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=400), st.randoms())
def test_any_text_comes_back_in_any_order(text: str, random) -> None:
    receiver = StatustextReceiver(GROUND)
    messages = chunks_of(text, 2, 77)
    random.shuffle(messages)
    for message in messages:
        receiver.receive(packet_of(message), START)
    expected = StatusText(VEHICLE, 2, text.removesuffix("\t"), has_event=text.endswith("\t"))
    assert receiver.events() == [expected]
