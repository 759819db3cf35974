"""Files that are written completely or not at all.

A process that is killed, or a disk that becomes full, must not leave a truncated file in place of a good one.
The content is therefore written to a temporary file in the same directory, which then takes the name of the
target in one step.
"""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from pathlib import Path

_PRIVATE = 0o600
_NEW_FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)


def write_file_atomically(
    path: str | os.PathLike[str], content: bytes | str, *, private: bool = False
) -> None:
    """Write a file, or leave an existing one unchanged if that fails.

    A symbolic link is followed, and the permissions of an existing file are kept. A device or a pipe is
    written directly.

    Args:
        path: The file.
        content: Its whole content; text is written as UTF-8 with its line ends unchanged.
        private: A new file is readable by its owner only, also if the one that it replaces was just deleted.

    Raises:
        OSError: The file cannot be written; there is no temporary file left.
    """
    data = content.encode() if isinstance(content, str) else content
    target = Path(os.path.realpath(path))
    try:
        known: os.stat_result | None = target.stat()
    except FileNotFoundError:
        known = None
    if known is not None and not stat.S_ISREG(known.st_mode):
        with Path(path).open("wb") as device:
            device.write(data)
        return
    temporary = target.with_name(f".mavstack-{os.urandom(6).hex()}.part")
    try:
        mode = (
            _PRIVATE if private and known is None else None if known is None else stat.S_IMODE(known.st_mode)
        )
        _write_new(temporary, data, mode)
        temporary.replace(target)
    except OSError as error:  # raise an error that names the target file, not the temporary file
        if error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, os.fspath(path)) from None
    finally:
        with suppress(OSError):
            temporary.unlink()


def _write_new(path: Path, data: bytes, mode: int | None) -> None:
    """Write a file that does not exist yet, and wait until it is on the disk."""
    with os.fdopen(os.open(path, _NEW_FILE, 0o666 if mode is None else _PRIVATE), "wb") as file:
        if mode is not None and hasattr(os, "fchmod"):
            os.fchmod(file.fileno(), mode)
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
