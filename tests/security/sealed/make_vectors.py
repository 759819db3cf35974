"""Writes vectors.json; needed again only if the wire format gets a new version.

The handshakes use fixed random numbers, except the encapsulation of ML-KEM-768, which the library makes.
"""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path

from mavstack.security.sealed import messages
from mavstack.security.sealed.noise import Identity, Initiator, Suite, respond
from mavstack.security.sealed.session import Session

PATH = Path(__file__).with_name("vectors.json")


def fixed(label: str, size: int = 32) -> bytes:
    """Return bytes that follow from a label."""
    return b"".join(sha256(f"{label} {number}".encode()).digest() for number in range(-(-size // 32)))[:size]


def identities(suite: Suite) -> tuple[Identity, Identity, bytes]:
    """Return the keys of both ends, and the public key of the initiator."""
    from mavstack.security.sealed.keys import public_key

    if not suite.pinned:
        shared = Identity(shared_key=fixed("shared key"))
        return shared, shared, b""
    one, two = fixed("initiator static"), fixed("responder static")
    return Identity(private_key=one, peer=public_key(two)), Identity(private_key=two), public_key(one)


def header(suite: Suite) -> bytes:
    """Return the header of the initiate."""
    return messages.initiate_header(suite, 1, messages.Challenge(fixed("nonce", 8), fixed("cookie", 16)))


def initiator(suite: Suite) -> Initiator:
    """Return the initiating end, with fixed random numbers."""
    draws = iter((fixed("initiator ephemeral"), fixed("kem seed", 64)))
    own, _, _ = identities(suite)
    return Initiator(suite, own, messages.prologue(header(suite)), lambda _size: next(draws))


def make(suite: Suite) -> dict[str, str]:
    """Return one vector."""
    own, other, public = identities(suite)
    begin = initiator(suite)
    first = begin.first_message()
    answer = respond(
        suite,
        other,
        messages.prologue(header(suite)),
        first,
        is_known=public.__eq__,
        random=lambda _size: fixed("responder ephemeral"),
    )
    sending, receiving = begin.read_second(answer.message)
    frames = Session(suite, (sending, receiving), 1, initiator=True, now=0.0)
    back = Session(suite, (answer.sending, answer.receiving), 1, initiator=False, now=0.0)
    values = {
        "shared_key": own.shared_key,
        "initiator_static": own.private_key,
        "responder_static": other.private_key,
        "initiator_ephemeral": fixed("initiator ephemeral"),
        "responder_ephemeral": fixed("responder ephemeral"),
        "kem_seed": fixed("kem seed", 64) if suite.hybrid else b"",
        "hello": messages.hello(suite, fixed("nonce", 8)),
        "challenge": messages.challenge(fixed("nonce", 8), fixed("cookie", 16)),
        "prologue": messages.prologue(header(suite)),
        "initiate": header(suite) + first,
        "first": first,
        "second": answer.message,
        "respond": messages.respond(fixed("nonce", 8), answer.message),
        "content": b"two packets of MAVLink",
        "frame": frames.seal(b"two packets of MAVLink"),
        "next_frame": frames.seal(b""),
        "frame_of_responder": back.seal(b"an answer"),
    }
    return {"suite": suite.name.decode()} | {name: value.hex() for name, value in values.items()}


_BOTH = (False, True)
SUITES = [Suite(pinned, hybrid, aes) for aes in _BOTH for pinned in _BOTH for hybrid in _BOTH]

if __name__ == "__main__":
    PATH.write_text(json.dumps([make(suite) for suite in SUITES], indent=1) + "\n")
