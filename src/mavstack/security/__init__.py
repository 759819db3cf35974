"""Signing keys and their timestamps, and the redaction of secrets.

The names are imported when they are used: a router without keys starts without hashes.
"""

from __future__ import annotations

from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.security.keys import SigningKey
    from mavstack.security.redaction import carries_signing_key, has_secret_fields, redact, strip_signature
    from mavstack.security.timestamps import TimestampStore

__all__ = [
    "SigningKey",
    "TimestampStore",
    "carries_signing_key",
    "has_secret_fields",
    "redact",
    "strip_signature",
]

_LAZY_IMPORTS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "SigningKey": "keys",
        "TimestampStore": "timestamps",
        "carries_signing_key": "redaction",
        "has_secret_fields": "redaction",
        "redact": "redaction",
        "strip_signature": "redaction",
    }
)


def __getattr__(name: str) -> Any:  # noqa: ANN401 (any of the names above)
    module = _LAZY_IMPORTS.get(name)
    if module is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{module}"), name)
