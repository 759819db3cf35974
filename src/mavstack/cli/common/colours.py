"""Colours on a terminal whose user did not ask for none; nothing else knows an escape sequence."""

from __future__ import annotations

import os
import sys
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import TextIO

_CODES: Final[Mapping[str, str]] = MappingProxyType(
    {"bold": "1", "red": "31", "green": "32", "yellow": "33", "cyan": "36", "grey": "90", "alarm": "1;31"}
)


def colored(text: str, colour: str, stream: TextIO | None = None) -> str:
    """A text in a colour, if the stream (standard output) is a terminal."""
    out = sys.stdout if stream is None else stream
    if not colour or not out.isatty() or os.environ.get("NO_COLOR"):
        return text
    return f"\x1b[{_CODES[colour]}m{text}\x1b[0m"
