"""Redaction of packets for logs and recordings: secret fields are blanked, signatures removed.

SETUP_SIGNING is the most important case: it carries a signing key unencrypted, and is never forwarded. A
collection of signed packets helps to attack the key, and a signed packet can be replayed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import Dialect
from mavstack.dialects.secrets import SECRET_FIELDS, SECRET_IDS, SETUP_SIGNING_ID, secret_fields
from mavstack.wire import crc16, encode

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.wire import Packet

#: The incompatibility flag of a signed packet, and the length of the signature in bytes.
_SIGNED: Final = 0x01
_SIGNATURE: Final = 13
_CRC: Final = 2


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
        The bytes without the signature; if the message has secret fields, with these fields blanked.
    """
    if not has_secret_fields(packet):
        return strip_signature(packet) if packet.signed else packet.raw
    return encode(
        _blanked(packet),
        system=packet.system,
        component=packet.component,
        sequence=packet.sequence,
        version=packet.version,
    )


def strip_signature(packet: Packet) -> bytes:
    """Return the bytes of a packet as if it had not been signed.

    Args:
        packet: The packet, whose CRC is right; its dialect need not have the message.

    Returns:
        The packet without signature, with a new CRC; the unchanged bytes of an unsigned packet.
    """
    raw = packet.raw
    if not packet.signed:
        return raw
    end = len(raw) - _SIGNATURE - _CRC
    old = int.from_bytes(raw[end : end + _CRC], "little")
    body = bytes((raw[1], raw[2] & ~_SIGNED)) + raw[3:end]
    crc = crc16(bytes((_crc_extra(raw[1:end], old),)), crc16(body))
    return raw[:1] + body + crc.to_bytes(_CRC, "little")


def _crc_extra(covered: bytes, crc: int) -> int:
    """Return the CRC_EXTRA of the message, the last byte that the CRC of a packet covers."""
    before = crc16(covered)
    return next(extra for extra in range(256) if crc16(bytes((extra,)), before) == crc)


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
