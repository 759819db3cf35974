"""Mavstack's folders in the user's folders of each platform; none of them has to exist yet.

The library platformdirs knows the places: `~/.config`, `~/.local/state` and `~/.cache` or the XDG variables
on Linux, `~/Library` on macOS, `%APPDATA%` and `%LOCALAPPDATA%` on Windows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from platformdirs.api import PlatformDirsABC


def cache_directory() -> Path:
    """Return the folder of files that save work and may be removed at any time.

    Raises:
        RuntimeError: There is no home directory.
    """
    return _absolute(_directories().user_cache_path)


def state_directory() -> Path:
    """Return the folder of files that programs keep between sessions, such as histories.

    Raises:
        RuntimeError: There is no home directory.
    """
    return _absolute(_directories().user_state_path)


def data_directory() -> Path:
    """Return the folder of files that a user has downloaded or made, such as maps.

    Raises:
        RuntimeError: There is no home directory.
    """
    return _absolute(_directories().user_data_path)


def config_directory() -> Path:
    """Return the folder of files that belong to the user, such as keys; on Windows it roams with the user.

    Raises:
        RuntimeError: There is no home directory.
    """
    return _absolute(_directories(roaming=True).user_config_path)


def _directories(*, roaming: bool = False) -> PlatformDirsABC:
    from platformdirs import PlatformDirs

    return PlatformDirs("mavstack", appauthor=False, roaming=roaming)


def _absolute(path: Path) -> Path:
    if not path.is_absolute():  # an unknown home directory stays `~`
        raise RuntimeError("the home directory cannot be determined")
    return path
