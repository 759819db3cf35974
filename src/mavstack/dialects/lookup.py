"""A dialect by what a user types: the name of an official one, or the path of a definition file."""

from __future__ import annotations

from mavstack.dialects.dialect import Dialect
from mavstack.errors import UnknownDialectError


def find_dialect(name: str) -> Dialect:
    """Load an official dialect by its name, or a custom one by the path of its file, which ends in `.xml`.

    Raises:
        DialectError: The file cannot be loaded.
        UnknownDialectError: There is no such file, or no official dialect of that name.
    """
    name = name.strip()
    if not name.lower().endswith(".xml"):
        return Dialect.load(name)
    from pathlib import Path  # imported here: the import takes longer than loading an official dialect

    path = Path(name).expanduser()
    if not path.exists():
        raise UnknownDialectError("no such file", str(path))
    return Dialect.from_xml(path)
