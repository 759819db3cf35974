"""Signing keys sent as signed and encrypted offers."""

from __future__ import annotations

import hashlib
import pickle

import pytest

from mavstack.errors import SigningError
from mavstack.security import SigningKey
from mavstack.security.key_offer import OFFER_SIZE, Identity, PublicIdentity

NOW = 1_790_000_000
#: Identities of fixed secrets, for vectors.
ANN, BOB, EVE = (Identity(bytes([number]) * 96) for number in (1, 2, 3))
KEY = SigningKey.from_passphrase("fleet")


def test_the_public_identity_follows_from_the_secret():
    assert ANN.public.fingerprint == ("648f9ddb50f427436a903759bfbba64406073b6d1ebf2d0062d8ac9768994eb0")
    assert PublicIdentity(ANN.public.data) == ANN.public
    assert Identity(ANN.secret_bytes()).public == ANN.public
    assert Identity.generate().public != Identity.generate().public


def test_the_recipient_gets_the_key():
    offer = ANN.offer(KEY, BOB.public, NOW)
    assert len(offer) == OFFER_SIZE == 4522
    assert KEY.secret_bytes() not in offer
    assert BOB.accept(offer, ANN.public, NOW + 5) == (KEY, NOW)


def test_an_offer_is_for_one_recipient_from_one_sender_and_used_once():
    offer = ANN.offer(KEY, BOB.public, NOW)
    for identity, sender, newest, now, reason in [
        (EVE, ANN, 0, NOW, "for another station"),
        (BOB, EVE, 0, NOW, "another station signed it"),
        (BOB, ANN, NOW, NOW, "not newer"),
        (BOB, ANN, 0, NOW - 301, "in the future"),
    ]:
        with pytest.raises(SigningError, match=reason):
            identity.accept(offer, sender.public, now, newest=newest)


def test_any_changed_byte_is_refused():
    offer = ANN.offer(KEY, BOB.public, NOW)
    for place in (0, 4, 5, 12, 13, 44, 45, 76, 77, 1164, 1165, 1212, 1213, len(offer) - 1):
        changed = bytearray(offer)
        changed[place] ^= 1
        with pytest.raises(SigningError, match="accepting the key offer failed"):
            BOB.accept(bytes(changed), ANN.public, NOW)
    for wrong in (b"", offer[:-1], offer + b"\0"):
        with pytest.raises(SigningError, match="no key offer"):
            BOB.accept(wrong, ANN.public, NOW)


def test_a_forged_sender_is_refused():
    offer = bytearray(EVE.offer(KEY, BOB.public, NOW))
    offer[13:45] = hashlib.sha256(ANN.public.data).digest()
    with pytest.raises(SigningError, match="signature is wrong"):
        BOB.accept(bytes(offer), ANN.public, NOW)


def test_secrets_are_never_shown():
    assert repr(ANN) == "Identity(…)"
    with pytest.raises(SigningError, match="pickled"):
        pickle.dumps(ANN)
    with pytest.raises(SigningError, match="96 bytes"):
        Identity(b"short")
    with pytest.raises(SigningError, match="3136 bytes"):
        PublicIdentity(b"short")
