"""What must never be written down: SETUP_SIGNING carries a signing key in the clear.

It is never forwarded, and whoever records packets records it blanked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import Dialect
from mavstack.wire import encode

if TYPE_CHECKING:
    from mavstack.wire import Packet

SECRET_MESSAGES = frozenset({"SETUP_SIGNING"})


def redacted(packet: Packet) -> bytes:
    """The bytes to record for `packet`: as they came, or blanked and unsigned if they hold a secret."""
    secret = _secret_name(packet)
    if secret is None:
        return packet.raw
    blank = Dialect.load("common")[secret] if packet.message is None else type(packet.message)
    return encode(
        blank(),
        system=packet.system,
        component=packet.component,
        sequence=packet.sequence,
        version=packet.version,
    )


def _secret_name(packet: Packet) -> str | None:
    """The name of the secret message in `packet`; a dialect that lacks the message hides no secret."""
    if packet.name is not None:
        return packet.name if packet.name in SECRET_MESSAGES else None
    common = Dialect.load("common")
    return next((name for name in SECRET_MESSAGES if common[name].definition.id == packet.message_id), None)
