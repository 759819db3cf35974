"""Modules and stubs of a user's dialect, so that type checkers and editors know its messages.

The module is generated beside a copy of the definition file, which it loads on first use: `import mine` then
gives typed classes (`mine.Spray(rate=3)`), and the module itself is a dialect (`Parser(mine)`). A package
generates its module when it is built, or checks a committed one with `outdated_files`.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.dialects.dialect import Dialect
from mavstack.dialects.includes import collect, included_first
from mavstack.dialects.names import to_identifier
from mavstack.dialects.stubs import file_module_text, file_stub_text
from mavstack.dialects.xml_reader import read_bytes
from mavstack.errors import DialectError

if TYPE_CHECKING:
    from os import PathLike


def write_dialect_module(path: str | PathLike[str], folder: str | PathLike[str]) -> list[Path]:
    """Write the module and the stub of a definition file, and copy the file beside them.

    Args:
        path: The definition file.
        folder: Folder of the module; it is created if necessary.

    Returns:
        The files that belong to the module: the module, its stub and the definition files.

    Raises:
        DialectError: The file is not valid, or includes a file outside its folder.
        OSError: A file cannot be written.
    """
    files = _files(Path(path), Path(folder))
    for file, content in files.items():
        file.parent.mkdir(parents=True, exist_ok=True)
        if not file.exists() or file.read_bytes() != content:
            write_file_atomically(file, content)
    return list(files)


def outdated_files(path: str | PathLike[str], folder: str | PathLike[str]) -> list[Path]:
    """Return the files that `write_dialect_module` would write or change.

    Args:
        path: The definition file.
        folder: Folder of the module.

    Raises:
        DialectError: The file is not valid, or includes a file outside its folder.
    """
    files = _files(Path(path), Path(folder))
    return [file for file, content in files.items() if not file.is_file() or file.read_bytes() != content]


def _files(path: Path, folder: Path) -> dict[Path, bytes]:
    """Return the content of each file of the module."""
    dialect = Dialect.from_xml(path)
    module = folder / f"{to_identifier(re.sub(r'[^0-9a-z_]', '_', dialect.name.lower()))}.py"
    files = {
        module: file_module_text(path.name, dialect.name).encode(),
        module.with_suffix(".pyi"): file_stub_text(dialect, path.name).encode(),
    }
    root = path.parent.resolve()
    for source in included_first(collect(str(path))):
        if source.official:
            continue
        definition = Path(source.definition.path)
        if not definition.resolve().is_relative_to(root):
            problem = "is included from outside the folder of the dialect; copy it beside the dialect"
            raise DialectError(problem, str(definition))
        files[folder / definition.resolve().relative_to(root)] = read_bytes(str(definition))
    return files
