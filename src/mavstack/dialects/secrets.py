"""Which fields hold what must never be shown or written down: keys, passwords and PINs sent in the clear.

With a secret goes what could help to guess or replay it. Messages are known by their ids too, for programs
whose dialect lacks them.
"""

from __future__ import annotations

from types import MappingProxyType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

#: Secret fields by message; their ids stand in SECRET_IDS.
SECRETS: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        "AIRLINK_AUTH": frozenset({"password"}),
        "AUTH_KEY": frozenset({"key"}),
        "CELLULAR_CONFIG": frozenset({"pin", "new_pin", "puk"}),
        "CHANGE_OPERATOR_CONTROL": frozenset({"passkey"}),
        "SETUP_SIGNING": frozenset({"secret_key", "initial_timestamp"}),
        "WIFI_CONFIG_AP": frozenset({"password"}),
    }
)
SECRET_IDS = frozenset({5, 7, 256, 299, 336, 52000})
_ANYWHERE = frozenset({"secret_key"})


def secret_fields(message: str) -> frozenset[str]:
    """The fields of a message that are never shown, by official names."""
    return SECRETS.get(message, _ANYWHERE)
