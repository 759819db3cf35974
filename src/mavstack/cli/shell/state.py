"""Files that the shell keeps between sessions, in the user's state directory of each platform."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.user_directories import state_directory

if TYPE_CHECKING:
    from pathlib import Path


def history_file(name: str = "shell") -> Path | None:
    """Return the file of a history, readable only for the user; None if it cannot be made."""
    try:
        path = state_directory() / f"{name}_history"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch(mode=0o600)
    except (OSError, RuntimeError):  # RuntimeError: the home directory is unknown
        return None
    return path
