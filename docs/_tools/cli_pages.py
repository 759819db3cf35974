"""The reference of the command line, from the argument parsers."""

from __future__ import annotations


def render() -> str:
    """Return the Markdown of every command."""
    from mavstack.cli import reference

    return reference.cli_reference()
