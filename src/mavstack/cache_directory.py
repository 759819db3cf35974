"""The folder for files that save work and may be removed at any time."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def cache_directory() -> Path:
    """Return Mavstack's folder in the platform's cache folder; it may not exist yet.

    Raises:
        RuntimeError: There is no home directory.
    """
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or str(Path.home() / "AppData" / "Local")
        return Path(base) / "mavstack" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "mavstack"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "mavstack"
