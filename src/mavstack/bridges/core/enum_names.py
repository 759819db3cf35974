"""The names of enum members in JSON and labels."""

from __future__ import annotations

from typing import Any


def enum_name(kind: Any, value: Any) -> str | None:
    """Return the name of a member; the number as text for values that the dialect does not know.

    Args:
        kind: The enum.
        value: The value; None: not known.

    Returns:
        The name, without the underscore before a digit; None for None.
    """
    if value is None:
        return None
    try:
        return str(kind(value).name).lstrip("_")
    except ValueError:
        return str(int(value))
