"""Sealed links: authenticated encryption between two ends that share a key or know each other's public key.

    noise        the handshakes of the Noise Protocol Framework, optionally with ML-KEM-768
    messages     the messages around them, and the cookies of the stateless first answer
    session      frames: 20 bytes more than their content, each accepted once
    responder, connector, tunnel    the state machines; time is an argument
    keys, config                    private and public keys
    cobs         datagrams over a byte stream

The package needs the extra `secure`.
"""

from __future__ import annotations

from mavstack.security.sealed.config import SealConfig
from mavstack.security.sealed.responder import Responder
from mavstack.security.sealed.tunnel import Tunnel

__all__ = ["Responder", "SealConfig", "Tunnel"]
