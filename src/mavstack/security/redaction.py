"""Redaction of packets for logs and recordings: secret fields are blanked.

SETUP_SIGNING is the most important case: it carries a signing key unencrypted, and is never forwarded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import Dialect
from mavstack.dialects.secrets import SECRET_FIELDS, SECRET_IDS, SETUP_SIGNING_ID, secret_fields
from mavstack.wire import encode

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.wire import Packet


def has_secret_fields(packet: Packet) -> bool:
    """Return whether the message of a packet has a secret field.

    Args:
        packet: The packet; its dialect need not have the message.

    Returns:
        True for messages with keys, passwords or PINs, such as SETUP_SIGNING.
    """
    return packet.name in SECRET_FIELDS or (packet.name is None and packet.message_id in SECRET_IDS)


def carries_signing_key(packet: Packet) -> bool:
    """Return whether a packet is a SETUP_SIGNING, which is never forwarded.

    Args:
        packet: The packet; its dialect need not have the message.

    Returns:
        True if the packet carries a signing key.
    """
    return packet.message_id == SETUP_SIGNING_ID and packet.name in ("SETUP_SIGNING", None)


def redact(packet: Packet) -> bytes:
    """Return the bytes of a packet without its secrets, for recording.

    Args:
        packet: The packet.

    Returns:
        The unchanged bytes; or, if the message has secret fields, an unsigned packet with these fields
        blanked.
    """
    if not has_secret_fields(packet):
        return packet.raw
    return encode(
        _blanked(packet),
        system=packet.system,
        component=packet.component,
        sequence=packet.sequence,
        version=packet.version,
    )


def _blanked(packet: Packet) -> Message:
    """Return the message with its secret fields blanked; all fields if the dialect lacks the message."""
    if packet.message is None:
        return Dialect.load("all")[packet.message_id]()
    message: Message = packet.message
    empty = type(message)()
    blanks = {name: getattr(empty, name) for name in secret_fields(message.definition.name)}
    return message.replace(
        **{name: value for name, value in blanks.items() if name in message.__match_args__}
    )
