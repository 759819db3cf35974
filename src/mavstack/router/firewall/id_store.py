"""The system ids of credentials on disk: a ground station keeps its id when the router starts again.

The file is JSON, `{"credential": id}`. Routers of one user share it; where two of them gave one id to two
credentials, the next run gives the id to the credential that comes first in the file.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

from mavstack.atomic_file import write_file_atomically
from mavstack.bounded_file import read_file_bounded
from mavstack.errors import RouterConfigError
from mavstack.security.file_lock import locked
from mavstack.security.key_store import key_directory

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

MAX_FILE_SIZE: Final = 1 << 20
_MAX_ID: Final = 255


def ids_path() -> Path:
    """Return the file with the ids that this user's routers assigned, beside the keys."""
    return key_directory().parent / "router.ids"


class IdStore:
    """The file with the assigned ids; a file with the suffix `.lock` is beside it.

    Args:
        path: Path of the file; it need not exist.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def load(self) -> dict[str, int]:
        """Read the assigned ids.

        Returns:
            The system id of each credential.

        Raises:
            RouterConfigError: The file cannot be read or is damaged.
        """
        try:
            data = read_file_bounded(self.path, MAX_FILE_SIZE + 1)
        except FileNotFoundError:
            return {}
        except OSError as error:
            raise RouterConfigError(f"cannot open {self.path}: {error.strerror or error}") from None
        try:
            known = json.loads(data)
            valid = isinstance(known, dict) and all(map(_is_id, known.values()))
        except (ValueError, RecursionError):
            valid = False
        if not valid or len(data) > MAX_FILE_SIZE:
            raise RouterConfigError(
                "no assigned system ids: mend or remove it; without it ids are assigned again", str(self.path)
            )
        return dict(known)

    def store(self, ids: Mapping[str, int]) -> None:
        """Add assigned ids to the file.

        Args:
            ids: The system id of each credential.

        Raises:
            RouterConfigError: The file cannot be read, is damaged, or cannot be written.
        """
        try:
            self.path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            with locked(self.path):
                merged = {**self.load(), **ids}
                write_file_atomically(self.path, json.dumps(merged, indent=1) + "\n")
        except OSError as error:
            raise RouterConfigError(f"cannot write {self.path}: {error.strerror or error}") from None


def _is_id(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= _MAX_ID
