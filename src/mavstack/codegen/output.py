"""Generated files in a folder: written, compared, and removed when a later generation has them no more.

A list of the files, `.mavgen-<language>.txt` in the folder, tells which files belong to a generation, so that
a file of a message that is gone does not stay, and a file of the user's is neither removed nor overwritten.
"""

# ruff: noqa: PTH103, PTH108, PTH110, PTH112, PTH113, PTH118, PTH120, PTH123, PTH208
# (for hundreds of files, paths as objects take longer than the files)
from __future__ import annotations

import errno
import fnmatch
import os
from typing import TYPE_CHECKING, Final

from mavstack.codegen.language import GeneratedFile, language
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from os import PathLike

    from mavstack.codegen.library import Library

_LISTS: Final = ".mavgen-*.txt"


def generate(library: Library, name: str) -> list[GeneratedFile]:
    """Generate a library in a language.

    Args:
        library: The library.
        name: The language, such as "c".

    Returns:
        The files, sorted by path, with the list of them.

    Raises:
        InvalidArgumentError: There is no such language, or a file of it is outside of the folder.
        MissingExtraError: Jinja2 is not installed.
    """
    files = sorted(language(name).render(library), key=lambda file: file.path)
    _check_paths(name, files)
    listed = "".join(f"{file.path}\n" for file in files)
    return [GeneratedFile(_list_name(name), listed), *files]


def _check_paths(name: str, files: list[GeneratedFile]) -> None:
    paths = [file.path for file in files]
    for path, other in zip(paths, ["", *paths], strict=False):
        if path == other or not _is_inside(path):
            raise InvalidArgumentError(f"language {name} generates {path!r} outside of its folder or twice")


def _is_inside(path: str) -> bool:
    return bool(path.strip("./")) and not path.startswith("/") and ".." not in path.split("/")


def write_files(
    files: list[GeneratedFile], folder: str | PathLike[str], *, overwrite: bool = False
) -> list[str]:
    """Write generated files, and remove files of an earlier generation that are not among them.

    Args:
        files: The files from `generate`.
        folder: The folder; it is created if necessary.
        overwrite: Overwrite files that were not generated.

    Returns:
        The paths of the files that were written or removed; none if the folder was up to date.

    Raises:
        FileExistsError: A file exists that was not generated, and `overwrite` is false; nothing was written.
        NotADirectoryError: The folder is a file.
        OSError: A file cannot be written or removed.
    """
    root = os.fspath(folder) or os.curdir
    if os.path.exists(root) and not os.path.isdir(root):
        raise NotADirectoryError(errno.ENOTDIR, "is a file, not a folder", root)
    changed, removed = _differences(files, root)
    if not overwrite:
        _check_overwritten(changed, root)
    for path in removed:
        os.unlink(path)
    for parent in sorted({os.path.dirname(path) for path in changed}):
        os.makedirs(parent, exist_ok=True)
    for path, content in changed.items():
        with open(path, "wb") as file:
            file.write(content)
    return [*changed, *removed]


def _check_overwritten(changed: dict[str, bytes], root: str) -> None:
    """Raise FileExistsError for a file that no generation of any language has written."""
    existing = [path for path in changed if os.path.exists(path)]
    if not existing:
        return
    lists = fnmatch.filter(os.listdir(root), _LISTS)
    generated = {path for name in lists for path in (os.path.join(root, name), *_earlier(name, root))}
    for path in existing:
        if path not in generated:
            raise FileExistsError(errno.EEXIST, "file exists and was not generated", path)


def outdated_files(files: list[GeneratedFile], folder: str | PathLike[str]) -> list[str]:
    """Return the paths of the files that `write_files` would write or remove.

    Args:
        files: The files from `generate`.
        folder: The folder.

    Raises:
        OSError: A file cannot be read.
    """
    changed, removed = _differences(files, os.fspath(folder) or os.curdir)
    return [*changed, *removed]


def _differences(files: list[GeneratedFile], root: str) -> tuple[dict[str, bytes], list[str]]:
    """Return the new content of files that differ, and the paths of files that are no longer generated."""
    wanted = {os.path.join(root, file.path): file.text.encode() for file in files}
    changed = {path: content for path, content in wanted.items() if _read(path) != content}
    return changed, [path for path in _earlier(files[0].path, root) if path not in wanted]


def _read(path: str) -> bytes | None:
    if not os.path.isfile(path):
        return None
    with open(path, "rb") as file:
        return file.read()


def _earlier(list_name: str, root: str) -> list[str]:
    """Return the existing files of an earlier generation; never one outside the folder."""
    listing = _read(os.path.join(root, list_name))
    names = listing.decode().splitlines() if listing is not None else []
    paths = (os.path.join(root, name) for name in names if _is_inside(name))
    return [path for path in paths if os.path.isfile(path)]


def _list_name(name: str) -> str:
    return f".mavgen-{name}.txt"
