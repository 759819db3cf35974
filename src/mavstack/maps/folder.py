"""The folder of a user's maps, from which the station serves tiles."""

from __future__ import annotations

import logging
import re
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.maps.archive import MapArchive, MapFacts
from mavstack.maps.failures import MapError
from mavstack.user_directories import data_directory

if TYPE_CHECKING:
    from pathlib import Path

logger = logging.getLogger("mavstack.maps")

SUFFIX: Final = ".mbtiles"
#: A valid name of a map: it contains no folder and does not begin with a dot.
NAME_PATTERN: Final = r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,62}"
_MAX_LISTED: Final = 1000


def default_folder() -> Path:
    """Return the folder of the user's maps; it need not exist.

    Raises:
        MapError: There is no home directory.
    """
    try:
        return data_directory() / "maps"
    except RuntimeError as error:
        raise MapError(f"finding the folder of maps failed: {error}; name one") from None


def map_path(folder: Path, name: str) -> Path:
    """Return the file of a map in a folder; raises `InvalidArgumentError` if the name is not allowed."""
    if re.fullmatch(NAME_PATTERN, name) is None:
        raise InvalidArgumentError(
            f"names of maps have letters, digits, _, . and -, and no folders, got {name[:60]!r}"
        )
    return folder / f"{name}{SUFFIX}"


def remove_map(path: Path) -> None:
    """Remove the file of a map.

    Raises:
        MapError: The file does not exist, or cannot be removed.
    """
    try:
        path.unlink()
    except OSError as error:
        raise MapError(f"removing {path} failed: {error.strerror or error}") from None


def list_maps(folder: Path) -> list[MapFacts]:
    """Return the facts of the maps in a folder, by name; damaged ones are left out with a warning."""
    if not folder.is_dir():
        return []
    found = []
    for path in sorted(folder.glob(f"*{SUFFIX}"))[:_MAX_LISTED]:
        if re.fullmatch(NAME_PATTERN, path.stem) is None:
            continue
        try:
            with MapArchive.open(path) as archive:
                found.append(archive.facts())
        except MapError as error:
            logger.warning("%s", error)
    return found
