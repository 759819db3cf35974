"""Keys and policy: who may speak on a link, and what must never be written down."""

from __future__ import annotations

from mavstack.security.keys import SigningKey
from mavstack.security.redaction import holds_secret, redacted
from mavstack.security.timestamps import TimestampStore

__all__ = ["SigningKey", "TimestampStore", "holds_secret", "redacted"]
