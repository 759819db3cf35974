"""Bounds of the definitions for which libraries are generated.

The time and the memory of a generation grow with the messages and the entries of enums. A foreign file can
hold tens of thousands in a few megabytes; the official definitions together have hundreds of messages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mavstack.dialects.model import EnumDefinition, MessageDefinition

MAX_MESSAGES: Final = 4096
MAX_FIELDS: Final = 65_536
MAX_ENTRIES: Final = 32_768


def check_size(messages: Sequence[MessageDefinition], enums: Iterable[EnumDefinition]) -> None:
    """Refuse definitions that are too large; raises `InvalidArgumentError`.

    Args:
        messages: The messages to generate.
        enums: The enums to generate.
    """
    counts = (
        ("messages", len(messages), MAX_MESSAGES),
        ("fields", sum(len(message.fields) for message in messages), MAX_FIELDS),
        ("entries of enums", sum(len(enum.entries) for enum in enums), MAX_ENTRIES),
    )
    for name, count, limit in counts:
        if count > limit:
            raise InvalidArgumentError(
                f"generating a library failed: the dialect has {count:,} {name}, more than {limit:,}: "
                "select messages with --only"
            )
