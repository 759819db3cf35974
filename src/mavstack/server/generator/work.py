"""The work of the generator's process: one form, read from stdin, in a folder that is deleted afterwards."""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final
from zipfile import ZIP_DEFLATED, ZipFile

#: Limits of the process: memory in bytes, processor time in seconds, and size of each file in bytes.
MAX_MEMORY: Final = 1 << 30
MAX_SECONDS: Final = 30
MAX_FILE: Final = 64 << 20
#: A high nice value: the process must not delay the station, which serves vehicles.
_NICENESS: Final = 10
#: The name of the result in the working folder.
ARCHIVE: Final = "library.zip"


@dataclass(frozen=True, slots=True)
class Work:
    """A form of the generator.

    Attributes:
        dialect: An official dialect; without meaning with `file`.
        file: The name of the definition file in the folder; empty: none.
        languages: Names of languages.
        folder: The folder of the libraries in the folder of the process.
        options: The entries `only`, `exclude` and `package`.
        archive: Generate the libraries; False: check the entries only.
    """

    dialect: str
    file: str
    languages: list[str]
    folder: str
    options: dict[str, str] = field(default_factory=dict)
    archive: bool = False

    def to_json(self) -> bytes:
        """Return the form for the process."""
        return json.dumps(asdict(self)).encode()


def main() -> None:
    """Carry out the form that comes on stdin; print the result, or its problem, as JSON."""
    _limit()
    work = Work(**json.loads(sys.stdin.buffer.read()))
    sys.stdout.write(json.dumps(carry_out(work, Path.cwd())))


def carry_out(work: Work, folder: Path) -> dict[str, Any]:
    """Check the entries of a form, or generate its libraries as a ZIP file.

    Args:
        work: The form.
        folder: The folder.

    Returns:
        `problems` and `commands`, or `refused`: the reason.
    """
    from mavstack.codegen.form import GenerationForm

    dialect = work.dialect
    if work.file:
        reason = _refused_includes(folder / work.file)
        if reason:
            return {"refused": reason}
        dialect = str(folder / work.file)
    form = GenerationForm(
        dialect=dialect,
        languages=tuple(work.languages),
        folder=str(folder / work.folder),
        **work.options,  # type: ignore[arg-type]
    )
    problems = {name: _without(text, folder) for name, text in form.problems.items()}
    if work.archive and problems:
        return {"refused": next(iter(problems.values()))}
    if not work.archive:
        commands = [] if problems else [_without(line, folder) for line in form.commands]
        return {"problems": problems, "commands": commands}
    for outcome in form.run():
        if outcome.failed:
            return {"refused": f"{outcome.language}: {_without(outcome.text, folder)}"}
    _write_archive(folder, work.folder)
    return {"problems": {}, "commands": []}


def _refused_includes(path: Path) -> str:
    """Return why a definition is refused: it includes others than official ones, files of the server."""
    from mavstack.dialects.tables import official_names
    from mavstack.dialects.xml_definitions import parse_definition
    from mavstack.errors import DialectError

    try:
        definition = parse_definition(path.read_bytes(), path.name, path.stem)
    except DialectError as error:
        return str(error)
    for include in definition.includes:
        if include.removesuffix(".xml") not in official_names():
            return f"only official definitions can be included, not {include[:60]!r}"
    return ""


def _write_archive(folder: Path, library: str) -> None:
    with ZipFile(folder / ARCHIVE, "w", ZIP_DEFLATED) as file:
        for path in sorted((folder / library).rglob("*")):
            if path.is_file():
                file.write(path, path.relative_to(folder))


def _without(text: str, folder: Path) -> str:
    """Return a text without the temporary folder."""
    return text.replace(f"{folder}/", "")


def _limit() -> None:
    """Limit the process, where the system can; its parent limits its time too, and takes precedence."""
    if sys.platform == "win32":
        return
    import resource

    os.nice(_NICENESS)

    limits = (
        (resource.RLIMIT_AS, MAX_MEMORY),
        (resource.RLIMIT_CPU, MAX_SECONDS),
        (resource.RLIMIT_FSIZE, MAX_FILE),
    )
    for name, value in limits:
        with suppress(ValueError, OSError):  # the system sets a lower limit already
            resource.setrlimit(name, (value, value))


if __name__ == "__main__":
    main()
