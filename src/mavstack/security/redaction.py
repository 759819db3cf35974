"""What must never be written down: SETUP_SIGNING carries a signing key in the clear.

It is never forwarded, and whoever records packets records it blanked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.wire import encode

if TYPE_CHECKING:
    from mavstack.wire import Packet

SECRET_MESSAGES = frozenset({"SETUP_SIGNING"})


def redacted(packet: Packet) -> bytes:
    """The bytes to record for `packet`: as they came, or blanked and unsigned if they hold a secret."""
    if packet.name not in SECRET_MESSAGES:
        return packet.raw
    return encode(
        type(packet.message)(),
        system=packet.system,
        component=packet.component,
        sequence=packet.sequence,
        version=packet.version,
    )
