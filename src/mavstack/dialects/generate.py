"""Generation of the tables, dialect modules and stubs from the definitions.

Run `python -m mavstack.dialects.generate` after changing a definition; with `--check` it reports outdated
files.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.dialects.codec import table_lines
from mavstack.dialects.dialect import Dialect
from mavstack.dialects.importer import read_file
from mavstack.dialects.stubs import module_text, stub_text

if TYPE_CHECKING:
    from collections.abc import Iterator

_HERE = Path(__file__).parent


def tables(folder: Path = _HERE) -> Iterator[tuple[Path, str]]:
    """Yield path and content of each table, generated from the definitions in `folder`."""
    for path in sorted((folder / "definitions").glob("*.xml")):
        definition = read_file(str(path))
        yield folder / "tables" / f"{definition.name}.jsonl", "\n".join(table_lines(definition)) + "\n"


def modules(folder: Path = _HERE) -> Iterator[tuple[Path, str]]:
    """Yield path and content of each module and stub, generated from the installed tables."""
    for path in sorted((folder / "definitions").glob("*.xml")):
        dialect = Dialect.load(path.stem)
        module = folder / f"{path.stem.lower()}.py"
        yield module, module_text(dialect.name)
        yield module.with_suffix(".pyi"), stub_text(dialect)


def out_of_date() -> list[Path]:
    """Return the generated files that are outdated."""
    expected = [*tables(), *modules()]
    stale = [path for path, text in expected if not path.exists() or path.read_text(encoding="utf-8") != text]
    known = {path for path, _ in expected}
    return stale + [path for path in (_HERE / "tables").glob("*.jsonl") if path not in known]


def generate() -> None:
    """Write all generated files: the tables first, because modules and stubs are generated from them."""
    for step in (tables, modules):
        for path, text in step():
            path.parent.mkdir(exist_ok=True)
            write_file_atomically(path, text)


def main(arguments: list[str]) -> int:
    """Run the command; return 0 on success, 1 if `--check` found outdated files, 2 for wrong usage."""
    if arguments not in ([], ["--check"]):
        sys.stderr.write("usage: python -m mavstack.dialects.generate [--check]\n")
        return 2
    if not arguments:
        generate()
        return 0
    stale = out_of_date()
    for path in stale:
        sys.stderr.write(f"out of date: {path}\n")
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
