"""Signing keys and their timestamps, and the redaction of secrets."""

from __future__ import annotations

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
