"""Files that the shell keeps between sessions, in the user's state directory of each platform."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def state_directory() -> Path:
    """Return the directory; it may not exist yet."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or str(Path.home() / "AppData" / "Local")
        return Path(base) / "mavstack"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "mavstack"
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "mavstack"


def history_file(name: str = "shell") -> Path | None:
    """Return the file of a history, readable only for the user; None if it cannot be made."""
    try:
        path = state_directory() / f"{name}_history"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch(mode=0o600)
    except (OSError, RuntimeError):  # RuntimeError: there is no home directory
        return None
    return path
