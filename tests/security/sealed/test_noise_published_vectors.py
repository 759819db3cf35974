"""The handshakes against the published vectors of other implementations of the Noise framework.

The handshakes of sealed links have no payloads, those of the vectors have. The tests encrypt the payload of
the vector where a handshake encrypts its empty one, and let the messages be longer by it; nothing else is
replaced.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mavstack.security.sealed import noise
from mavstack.security.sealed.noise import Identity, Initiator, Suite, public_of, respond

VECTORS = json.loads(Path(__file__).with_name("published_vectors.json").read_text("utf-8"))
SUITES = [Suite(pinned=pinned, aes=aes) for pinned in (False, True) for aes in (False, True)]
BY_NAME = {suite.name.decode(): suite for suite in SUITES}


@pytest.fixture
def payloads(monkeypatch):
    """The payloads of the two messages, to be set, and the hashes of the handshake after each."""
    encrypt = noise._State.encrypt
    sizes = Suite.first_size.fget, Suite.second_size.fget
    payloads, hashes = [], []

    def encrypt_payload(state, plain):
        sealed = encrypt(state, plain or payloads[len(hashes)])
        if not plain:
            hashes.append(state.hash)
        return sealed

    monkeypatch.setattr(noise._State, "encrypt", encrypt_payload)
    monkeypatch.setattr(Suite, "first_size", property(lambda suite: sizes[0](suite) + len(payloads[0])))
    monkeypatch.setattr(Suite, "second_size", property(lambda suite: sizes[1](suite) + len(payloads[1])))
    return payloads, hashes


def test_every_handshake_without_the_hybrid_extension_has_a_vector():
    assert {vector["protocol_name"] for vector in VECTORS} == set(BY_NAME)


@pytest.mark.parametrize(
    "vector", VECTORS, ids=[f"{each['source'].split('/')[0]} {each['protocol_name']}" for each in VECTORS]
)
def test_the_published_handshakes_are_reproduced(vector, payloads):
    def value(name):
        return bytes.fromhex(vector.get(name, ""))

    def identity(end):
        shared = bytes.fromhex("".join(vector.get(f"{end}_psks") or []))
        return Identity(shared, value(f"{end}_static"), value(f"{end}_remote_static"))

    suite, messages = BY_NAME[vector["protocol_name"]], vector["messages"]
    contents = [bytes.fromhex(each["payload"]) for each in messages]
    sealed = [bytes.fromhex(each["ciphertext"]) for each in messages]
    payloads[0].extend(contents[:2])
    initiator = Initiator(suite, identity("init"), value("init_prologue"), lambda _: value("init_ephemeral"))
    assert initiator.first_message() == sealed[0]
    answer = respond(
        suite,
        identity("resp"),
        value("resp_prologue"),
        sealed[0],
        is_known=lambda key: key == public_of(value("init_static")),
        random=lambda _: value("resp_ephemeral"),
    )
    assert answer.message == sealed[1]
    assert payloads[1][-1] == (value("handshake_hash") or payloads[1][-1])
    keys = initiator.read_second(sealed[1])
    assert keys == (answer.receiving, answer.sending)
    for number, (content, text) in enumerate(zip(contents[2:], sealed[2:], strict=True)):
        key, nonce = keys[number % 2], suite.nonce(number // 2)
        assert suite.cipher(key).encrypt(nonce, content, b"") == text
