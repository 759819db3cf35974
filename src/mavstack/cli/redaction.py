"""What is never shown: signing keys, passwords and PINs that some messages carry in the clear.

Everything in these messages that could help to guess or replay the secret is blanked with it, in tables and
in JSON. Where the dialect does not know a message, it is told by its id, and its raw bytes are not shown.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.wire import Packet

HIDDEN: Final = "(hidden)"

_SECRETS: Final[Mapping[str, frozenset[str]]] = MappingProxyType(
    {
        "AIRLINK_AUTH": frozenset({"password"}),
        "AUTH_KEY": frozenset({"key"}),
        "CELLULAR_CONFIG": frozenset({"pin", "new_pin", "puk"}),
        "CHANGE_OPERATOR_CONTROL": frozenset({"passkey"}),
        "SETUP_SIGNING": frozenset({"secret_key", "initial_timestamp"}),
        "WIFI_CONFIG_AP": frozenset({"password"}),
    }
)
_SECRET_IDS: Final = frozenset({5, 7, 256, 299, 336, 52000})
_NOWHERE: Final = frozenset({"secret_key"})


def secret_fields(message: str) -> frozenset[str]:
    """The fields of a message that are blanked, by official names."""
    return _SECRETS.get(message, _NOWHERE)


def raw_hex(packet: Packet) -> str:
    """The bytes of a packet as text, unless they hold a secret."""
    return HIDDEN if packet.message_id in _SECRET_IDS or packet.name in _SECRETS else packet.raw.hex()
