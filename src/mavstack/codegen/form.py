"""The form of code generation without its drawing: entries, their problems, and the work.

A user interface shows the entries of a `GenerationForm`, `problems` beside them, and after `run` an `Outcome`
for each language. It keeps no state of its own.
"""

from __future__ import annotations

import shlex
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.codegen.language import language_names
from mavstack.codegen.library import make_library, name_patterns
from mavstack.codegen.output import generate, outdated_files, write_files
from mavstack.dialects.lookup import find_dialect
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.codegen.library import Library


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result for one language.

    Attributes:
        language: Name of the language.
        folder: Folder of the library.
        text: The result in one line.
        failed: True if the library was not written, or is out of date.
    """

    language: str
    folder: Path
    text: str
    failed: bool = False


@dataclass(frozen=True, slots=True)
class GenerationForm:
    """The entries of the form.

    Attributes:
        dialect: Name of an official dialect, or path of a definition file.
        languages: Names of the languages. If there are several, each has a folder of its own in `folder`.
        folder: Output folder.
        only: Names and patterns of messages to generate, with commas; empty for all.
        exclude: Names and patterns of messages to leave out, with commas.
        package: Name of the package, module or namespace; empty for the default.
        overwrite: Overwrite files that were not generated.
    """

    dialect: str = "common"
    languages: tuple[str, ...] = ()
    folder: str = ""
    only: str = ""
    exclude: str = ""
    package: str = ""
    overwrite: bool = False

    def with_entry(self, name: str, value: str | bool | tuple[str, ...]) -> GenerationForm:
        """Return the form with another value of an entry."""
        return replace(self, **{name: value})  # type: ignore[arg-type]

    @property
    def problems(self) -> dict[str, str]:
        """The problem of each entry that prevents the generation, by the name of the entry."""
        found: dict[str, str] = {}
        unknown = [name for name in self.languages if name not in language_names()]
        if not self.languages:
            found["languages"] = "choose a language"
        elif unknown:
            found["languages"] = f"there is no language {unknown[0]}"
        if not self.folder.strip():
            found["folder"] = "name a folder"
        try:
            dialect = find_dialect(self.dialect)
        except (MavstackError, OSError) as error:
            return {"dialect": str(error), **found}
        for name, only, exclude in (("only", self.only, ""), ("exclude", "", self.exclude)):
            try:
                make_library(dialect, only=name_patterns(only), exclude=name_patterns(exclude))
            except MavstackError as error:
                found[name] = str(error)
        return found

    @property
    def commands(self) -> list[str]:
        """The command lines that do the same."""
        options = [f"--{name}={getattr(self, name)}" for name in ("only", "exclude", "package")]
        options = [option for option in options if not option.endswith("=")] + ["--force"] * self.overwrite
        return [
            shlex.join(["mav", "gen", name, self.dialect, "-o", str(self.folder_of(name)), *options])
            for name in self.languages
        ]

    def folder_of(self, name: str) -> Path:
        """Return the folder of the library in a language."""
        folder = Path(self.folder.strip()).expanduser()
        return folder / name if len(self.languages) > 1 else folder

    def run(self) -> list[Outcome]:
        """Write the libraries.

        Returns:
            The outcome of each language; an error in one of them does not prevent the others.
        """
        return [self._outcome(name, self._write) for name in self.languages]

    def check(self) -> list[Outcome]:
        """Compare the libraries with their folders, and write nothing.

        Returns:
            The outcome of each language.
        """
        return [self._outcome(name, self._compare) for name in self.languages]

    def _outcome(self, name: str, work: Callable[[Library, str], Outcome]) -> Outcome:
        try:
            library = make_library(
                find_dialect(self.dialect),
                only=name_patterns(self.only),
                exclude=name_patterns(self.exclude),
                package=self.package.strip(),
            )
            return work(library, name)
        except FileExistsError as error:
            text = f"{error.filename} was not generated: choose another folder, or overwrite"
        except OSError as error:
            text = f"cannot write {error.filename or self.folder_of(name)}: {error.strerror or error}"
        except MavstackError as error:
            text = str(error)
        return Outcome(name, self.folder_of(name), text, failed=True)

    def _write(self, library: Library, name: str) -> Outcome:
        folder, files = self.folder_of(name), generate(library, name)
        changed = write_files(files, folder, overwrite=self.overwrite)
        return Outcome(name, folder, f"{len(files) - 1} files, {len(changed)} changed")

    def _compare(self, library: Library, name: str) -> Outcome:
        folder, files = self.folder_of(name), generate(library, name)
        outdated = outdated_files(files, folder)
        text = f"{len(outdated)} files are out of date" if outdated else "up to date"
        return Outcome(name, folder, text, failed=bool(outdated))
