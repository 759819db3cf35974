"""The fields that must never be shown or stored: keys, passwords and PINs that are sent unencrypted.

Fields that help to guess or replay a secret are included. The messages are listed by id too, for dialects
that lack them.
"""

from __future__ import annotations

from types import MappingProxyType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

#: Secret fields by message; the ids of these messages are SECRET_IDS.
SECRET_FIELDS: Mapping[str, frozenset[str]] = MappingProxyType(
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
_SECRET_FIELD_NAMES = frozenset({"secret_key"})

#: The id of SETUP_SIGNING, which carries a signing key and must never be forwarded.
SETUP_SIGNING_ID = 256
#: The text that is shown in place of the value of a secret field.
HIDDEN = "(hidden)"


def secret_fields(message: str) -> frozenset[str]:
    """Return the names of the secret fields of a message."""
    return SECRET_FIELDS.get(message, _SECRET_FIELD_NAMES)
