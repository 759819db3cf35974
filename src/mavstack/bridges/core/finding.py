"""Findings of `mav bridge check`: statements in plain words about a bus and its peers."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """A statement.

    Attributes:
        ok: False if something does not work.
        text: The statement.
        name: The topic or service; empty for statements about a bridge.
        node: The full name of the other node; empty for statements about a bridge.
    """

    ok: bool
    text: str
    name: str = ""
    node: str = ""
