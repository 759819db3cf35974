"""Generated files in a folder: written, compared, and removed when a later generation has them no more.

A list of the files, `.mavgen-<language>.txt` in the folder, tells which files belong to a generation, so that
a file of a message that is gone does not stay, and a file of the user's is never removed.
"""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.codegen.language import GeneratedFile, language

if TYPE_CHECKING:
    from os import PathLike

    from mavstack.codegen.library import Library


def generate(library: Library, name: str) -> list[GeneratedFile]:
    """Generate a library in a language.

    Args:
        library: The library.
        name: The language, such as "c".

    Returns:
        The files, sorted by path, with the list of them.

    Raises:
        InvalidArgumentError: There is no such language.
        MissingExtraError: Jinja2 is not installed.
    """
    files = sorted(language(name).render(library), key=lambda file: file.path)
    listed = "".join(f"{file.path}\n" for file in files)
    return [GeneratedFile(_list_name(name), listed), *files]


def write_files(files: list[GeneratedFile], folder: str | PathLike[str]) -> list[Path]:
    """Write generated files, and remove files of an earlier generation that are not among them.

    Args:
        files: The files from `generate`.
        folder: The folder; it is created if necessary.

    Returns:
        The files that were written or removed; none if the folder was up to date.

    Raises:
        OSError: A file cannot be written or removed.
    """
    outdated = outdated_files(files, folder)
    texts = {Path(folder, file.path): file.text for file in files}
    for path in outdated:
        if path not in texts:
            path.unlink()
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        write_file_atomically(path, texts[path])
    return outdated


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
    inside = (Path(folder, name) for name in names if not name.is_absolute() and ".." not in name.parts)
    return [path for path in inside if path.is_file()]


def _list_name(name: str) -> str:
    return f".mavgen-{name}.txt"
