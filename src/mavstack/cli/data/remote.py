"""Logs and results on other file systems, named by URLs such as `s3://bucket/flight.tlog`.

fsspec knows the file systems; each may need a package of its own (s3fs, gcsfs, adlfs). A log is copied to a
temporary folder and read there, because reading maps the file into memory. Results are written to a temporary
folder and uploaded when they are complete.
"""

from __future__ import annotations

from contextlib import ExitStack, contextmanager
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from mavstack.errors import LogError, MavstackError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


def is_remote(path: str) -> bool:
    """Return whether a path is a URL."""
    return "://" in path


def expand(paths: Sequence[str]) -> list[str]:
    """Return paths with the patterns of URLs replaced by the files that match, in order.

    Args:
        paths: Local paths, which the shell has expanded, and URLs.

    Raises:
        LogError: A file system cannot be read, or a pattern matches nothing.
        MissingExtraError: fsspec or the package of a file system is not installed.
    """
    found: list[str] = []
    for path in paths:
        if is_remote(path) and any(sign in path for sign in "*?["):
            system, pattern = _open(path)
            names = _call(path, system.glob, pattern)
            matches = [str(_call(path, system.unstrip_protocol, name)) for name in names]
            if not matches:
                raise LogError(f"{path}: no file matches")
            found += sorted(matches)
        else:
            found.append(path)
    return found


class LocalCopies(ExitStack):
    """The copies of logs at URLs that a command reads; they are removed at the end of the block."""

    def __init__(self) -> None:
        super().__init__()
        #: The URL from which each copy was made, by the path of the copy.
        self.names: dict[str, str] = {}

    def path_of(self, url: str) -> str:
        """Copy a log once, and return the path of the copy.

        Raises:
            LogError: The file cannot be read.
        """
        for path, name in self.names.items():
            if name == url:
                return path
        path = self.enter_context(local_copy(url))
        self.names[path] = url
        return path


@contextmanager
def local_copy(path: str) -> Iterator[str]:
    """Give a log as a local file for the length of a block.

    Args:
        path: Local path, or URL.

    Yields:
        The local path, or that of a copy with the same name.

    Raises:
        LogError: The file cannot be read.
    """
    if not is_remote(path):
        yield path
        return
    system, name = _open(path)
    with TemporaryDirectory(prefix="mavstack-") as folder:
        target = Path(folder) / Path(name).name
        _call(path, system.get_file, name, str(target))
        yield str(target)


@contextmanager
def local_result(path: str) -> Iterator[str]:
    """Give a local path to write to, and upload what was written at the end of the block.

    Args:
        path: Local path, or URL of a file or folder.

    Yields:
        The local path to write.

    Raises:
        LogError: The result cannot be uploaded.
    """
    if not is_remote(path):
        yield path
        return
    system, name = _open(path)
    with TemporaryDirectory(prefix="mavstack-") as folder:
        target = Path(folder) / Path(name).name
        yield str(target)
        for file in [target] if target.is_file() else sorted(target.rglob("*")):
            if file.is_file():
                remote = f"{name.rstrip('/')}/{file.relative_to(target).as_posix()}".removesuffix("/.")
                _call(path, _put, system, str(file), remote, operation="write")


def _put(system: Any, file: str, remote: str) -> None:  # noqa: ANN401 (fsspec has no types)
    system.makedirs(system._parent(remote), exist_ok=True)  # noqa: SLF001 (fsspec has no public one)
    system.put_file(file, remote)


def _open(path: str) -> tuple[Any, str]:
    """Return the file system of a URL, and the path on it."""
    try:
        core = import_module("fsspec.core")
    except ImportError:
        raise MissingExtraError("a file at a URL", "remote") from None
    system, name = _call(path, core.url_to_fs, path)
    return system, name


def _call(path: str, function: Any, *arguments: Any, operation: str = "open") -> Any:  # noqa: ANN401 (no types)
    """Call fsspec; the exceptions of its file systems have no common class."""
    try:
        return function(*arguments)
    except MavstackError:
        raise
    except Exception as error:
        raise LogError(f"cannot {operation} {path}: {_reason(error)}") from error


def _reason(error: Exception) -> str:
    """Return the first line of the text of an exception, which may have none, or attributes of any kind."""
    texts = (str(getattr(error, "strerror", None) or ""), str(error), type(error).__name__)
    return next(line.strip() for text in texts for line in text.splitlines() if line.strip())
