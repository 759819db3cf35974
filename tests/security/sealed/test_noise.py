"""The handshakes against vectors, which a second implementation reads."""

from __future__ import annotations

import json

import pytest

from mavstack.security.sealed import messages
from mavstack.security.sealed.noise import HandshakeError, Identity, Initiator, Suite, respond
from mavstack.security.sealed.session import FrameError, Session

from .make_vectors import PATH, SUITES, fixed, header, identities, initiator, make
from .slow import open_, seal, transcript_keys

VECTORS = json.loads(PATH.read_text())
BY_SUITE = pytest.mark.parametrize(
    ("suite", "vector"),
    list(zip(SUITES, VECTORS, strict=True)),
    ids=[vector["suite"] for vector in VECTORS],
)


@BY_SUITE
def test_the_vectors_are_reproduced(suite, vector):
    made = make(suite)
    if suite.hybrid:  # the encapsulation is random: what follows from it differs
        for name in ("second", "respond", "frame", "next_frame", "frame_of_responder"):
            assert len(made.pop(name)) == len(vector[name])
    assert made.items() <= vector.items()


@BY_SUITE
def test_the_initiator_reads_the_recorded_answer(suite, vector):
    begin = initiator(suite)
    begin.first_message()
    keys = begin.read_second(bytes.fromhex(vector["second"]))
    session = Session(suite, keys, 1, initiator=True, now=0.0)
    assert session.seal(bytes.fromhex(vector["content"])).hex() == vector["frame"]
    assert session.open(bytes.fromhex(vector["frame_of_responder"])) == b"an answer"


@pytest.mark.parametrize("vector", VECTORS[:4], ids=[vector["suite"] for vector in VECTORS[:4]])
def test_a_second_implementation_agrees(vector):
    one, two = transcript_keys(vector)
    content = bytes.fromhex(vector["content"])
    head = (0xD0000000).to_bytes(4)  # a frame, of the initiator, epoch 1, counter 0
    assert (head + seal(one, 0, content, head)).hex() == vector["frame"]
    back = bytes.fromhex(vector["frame_of_responder"])
    assert back[:4] == (0x90000000).to_bytes(4)
    assert open_(two, 0, back[4:], back[:4]) == b"an answer"


@pytest.mark.parametrize("suite", SUITES, ids=[vector["suite"] for vector in VECTORS])
def test_any_changed_byte_is_refused(suite):
    _, other, public = identities(suite)
    begin = initiator(suite)
    first = begin.first_message()
    assert len(first) == suite.first_size

    def answer(message: bytes):
        return respond(
            suite,
            other,
            messages.prologue(header(suite)),
            message,
            is_known=public.__eq__,
            random=fixed_random,
        )

    for position in {*range(0, len(first), 61), len(first) - 1}:
        with pytest.raises(HandshakeError):
            answer(changed(first, position))
    with pytest.raises(HandshakeError):
        answer(first[:-1])
    good = answer(first)
    assert len(good.message) == suite.second_size
    for position in {*range(0, len(good.message), 97), len(good.message) - 1}:
        with pytest.raises(HandshakeError):
            begin.read_second(changed(good.message, position))
    assert begin.read_second(good.message) == (good.receiving, good.sending)


def fixed_random(size: int) -> bytes:
    return fixed("x", size)


def changed(data: bytes, position: int) -> bytes:
    return data[:position] + bytes((data[position] ^ 1,)) + data[position + 1 :]


def test_an_unknown_public_key_is_refused():
    suite = Suite(pinned=True)
    _, other, _ = identities(suite)
    first = initiator(suite).first_message()
    with pytest.raises(HandshakeError):
        respond(
            suite,
            other,
            messages.prologue(header(suite)),
            first,
            is_known=lambda _key: False,
            random=fixed_random,
        )


def test_a_point_of_low_order_is_refused():
    suite = Suite()
    begin = initiator(suite)
    begin.first_message()
    with pytest.raises(HandshakeError):
        begin.read_second(bytes(suite.second_size))
    with pytest.raises(HandshakeError):
        Initiator(
            Suite(pinned=True), Identity(private_key=bytes(32), peer=bytes(32)), b"", fixed_random
        ).first_message()


def test_keys_are_not_shown():
    own, _, _ = identities(Suite())
    assert repr(own) == "Identity(…)"


def test_a_forged_frame_is_refused():
    session = Session(Suite(), (bytes(32), bytes(32)), 0, initiator=True, now=0.0)
    with pytest.raises(FrameError, match="forged"):
        session.open(bytes(24))
