"""Packets as they may be written down: what holds a secret is blanked by whoever records or shows it.

SETUP_SIGNING above all: it carries a signing key in the clear, and is never forwarded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import Dialect
from mavstack.dialects.secrets import SECRET_IDS, SECRETS, secret_fields
from mavstack.wire import encode

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.wire import Packet


def holds_secret(packet: Packet) -> bool:
    """Whether the packet's message has a field that must not be shown, its dialect knowing it or not."""
    return packet.name in SECRETS or (packet.name is None and packet.message_id in SECRET_IDS)


def redacted(packet: Packet) -> bytes:
    """The bytes to record for `packet`: as they came, or unsigned and with its secrets blanked."""
    if not holds_secret(packet):
        return packet.raw
    return encode(
        _blanked(packet),
        system=packet.system,
        component=packet.component,
        sequence=packet.sequence,
        version=packet.version,
    )


def _blanked(packet: Packet) -> Message:
    """The message without its secrets; nothing is left of one that the packet's dialect does not know."""
    if packet.message is None:
        return Dialect.load("all")[packet.message_id]()
    message: Message = packet.message
    empty = type(message)()
    blanks = {name: getattr(empty, name) for name in secret_fields(message.definition.name)}
    return message.replace(
        **{name: value for name, value in blanks.items() if name in message.__match_args__}
    )
