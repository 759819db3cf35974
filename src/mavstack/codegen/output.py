"""Generated files in a folder: written, compared, and removed when a later generation has them no more.

A list of the files, `.mavgen-<language>.txt` in the folder, tells which files belong to a generation, so that
a file of a message that is gone does not stay, and a file of the user's is neither removed nor overwritten.
"""

from __future__ import annotations

import errno
from pathlib import Path, PurePosixPath
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
    for file, other in zip(files, [None, *files], strict=False):
        if not _is_inside(PurePosixPath(file.path)) or (other and other.path == file.path):
            raise InvalidArgumentError(
                f"language {name} generates {file.path!r} outside of its folder or twice"
            )


def _is_inside(path: PurePosixPath) -> bool:
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts


def write_files(
    files: list[GeneratedFile], folder: str | PathLike[str], *, overwrite: bool = False
) -> list[Path]:
    """Write generated files, and remove files of an earlier generation that are not among them.

    Args:
        files: The files from `generate`.
        folder: The folder; it is created if necessary.
        overwrite: Overwrite files that were not generated.

    Returns:
        The files that were written or removed; none if the folder was up to date.

    Raises:
        FileExistsError: A file exists that was not generated, and `overwrite` is false; nothing was written.
        NotADirectoryError: The folder is a file.
        OSError: A file cannot be written or removed.
    """
    if Path(folder).exists() and not Path(folder).is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "is a file, not a folder", str(folder))
    outdated = outdated_files(files, folder)
    texts = {Path(folder, file.path): file.text for file in files}
    if not overwrite:
        _check_overwritten(outdated, folder)
    for path in outdated:
        if path not in texts:
            path.unlink()
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(texts[path].encode())
    return outdated


def _check_overwritten(outdated: list[Path], folder: str | PathLike[str]) -> None:
    """Raise FileExistsError for a file that no generation of any language has written."""
    generated = {path for listing in Path(folder).glob(_LISTS) for path in _earlier(listing.name, folder)}
    for path in outdated:
        if path not in generated and path.exists() and not path.match(_LISTS):
            raise FileExistsError(errno.EEXIST, "file exists and was not generated", str(path))


def outdated_files(files: list[GeneratedFile], folder: str | PathLike[str]) -> list[Path]:
    """Return the files that `write_files` would write or remove.

    Args:
        files: The files from `generate`.
        folder: The folder.

    Raises:
        OSError: A file cannot be read.
    """
    wanted = {Path(folder, file.path): file.text.encode() for file in files}
    changed = [path for path, content in wanted.items() if not path.is_file() or path.read_bytes() != content]
    return changed + [path for path in _earlier(files[0].path, folder) if path not in wanted]


def _earlier(list_name: str, folder: str | PathLike[str]) -> list[Path]:
    """Return the existing files of an earlier generation; never one outside the folder."""
    listing = Path(folder, list_name)
    if not listing.is_file():
        return []
    names = (PurePosixPath(line) for line in listing.read_text(encoding="utf-8").splitlines() if line)
    inside = (Path(folder, name) for name in names if _is_inside(name))
    return [path for path in inside if path.is_file()]


def _list_name(name: str) -> str:
    return f".mavgen-{name}.txt"
