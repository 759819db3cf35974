"""`mav gen`: generate libraries in other languages from the definitions of a dialect."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.collection import no_collection
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import echo, echo_json
from mavstack.dialects.lookup import find_dialect
from mavstack.errors import InvalidArgumentError, MissingExtraError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.codegen import GeneratedFile

EXAMPLES: Final = """\
examples:
  mav gen --list                                    # the languages
  mav gen --ui                                      # a form on the terminal
  mav gen c common -o include                       # header-only C99: #include "common/mavlink.h"
  mav gen typescript mine.xml -o mavlink-ts         # a custom dialect, with the files that it includes
  mav gen c common --only HEARTBEAT,ATTITUDE,GPS* -o include   # a few messages, for a small device
  mav gen java common --package org.example.mavlink -o java
  mav gen python ardupilotmega -o src --check       # for the build: fail if a file is out of date
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    parser.add_argument("language", metavar="LANGUAGE", nargs="?", help="language of the library")
    parser.add_argument(
        "dialect", metavar="DIALECT|FILE.xml", nargs="?", help="official dialect or definition file"
    )
    parser.add_argument("-o", "--output", metavar="DIR", help="folder of the library")
    parser.add_argument(
        "--only", metavar="MESSAGES", default="", help="messages to generate: names and patterns with commas"
    )
    parser.add_argument(
        "--exclude", metavar="MESSAGES", default="", help="messages to leave out: names and patterns"
    )
    parser.add_argument(
        "--package", metavar="NAME", default="", help="name of the package, module or namespace"
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit with 1 if a file is out of date"
    )
    parser.add_argument("--force", action="store_true", help="overwrite files that mav gen did not write")
    parser.add_argument("--ui", action="store_true", help="choose everything in a form on the terminal")
    parser.add_argument("--list", action="store_true", help="list the languages")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: Namespace) -> int:
    """Run `mav gen`."""
    if arguments.list:
        return _list(arguments)
    if arguments.ui:
        return _show_form(arguments)
    if not (arguments.language and arguments.dialect and arguments.output):
        raise UsageError("name a language, a dialect and a folder: mav gen c common -o include")
    from mavstack.codegen import outdated_files, write_files

    with no_collection():
        files = _generate(arguments)
    if arguments.check:
        return _check(outdated_files(files, arguments.output), arguments)
    try:
        changed = write_files(files, arguments.output, overwrite=arguments.force)
    except FileExistsError as error:
        raise CommandError(
            f"{error.filename} was not written by mav gen; choose another folder, or overwrite with --force"
        ) from None
    if arguments.json:
        echo_json({"files": [file.path for file in files], "changed": changed})
    else:
        echo(f"{arguments.output}: {len(files) - 1} files, {len(changed)} changed")
    return 0


def _generate(arguments: Namespace) -> list[GeneratedFile]:
    from mavstack.codegen import generate, make_library
    from mavstack.codegen.library import name_patterns

    try:
        library = make_library(
            find_dialect(arguments.dialect),
            only=name_patterns(arguments.only),
            exclude=name_patterns(arguments.exclude),
            package=arguments.package,
        )
        return generate(library, arguments.language)
    except InvalidArgumentError as error:
        raise UsageError(str(error)) from None


def _show_form(arguments: Namespace) -> int:
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise UsageError("--ui needs a terminal")
    try:
        from mavstack.cli.gen.window import GenerationWindow
    except ImportError:
        raise MissingExtraError("mav gen --ui", "tui") from None
    from mavstack.codegen.form import GenerationForm

    form = GenerationForm(
        dialect=arguments.dialect or "common",
        languages=(arguments.language,) if arguments.language else (),
        folder=arguments.output or "",
        only=arguments.only,
        exclude=arguments.exclude,
        package=arguments.package,
        overwrite=arguments.force,
    )
    return GenerationWindow(form).run() or 0


def _check(outdated: list[str], arguments: Namespace) -> int:
    if arguments.json:
        echo_json({"outdated": outdated})
    else:
        for path in outdated:
            echo(f"mav gen: out of date: {path}", error=True)
    return 1 if outdated else 0


def _list(arguments: Namespace) -> int:
    from mavstack.codegen import language, language_names

    titles = {name: language(name).title for name in language_names()}
    if arguments.json:
        echo_json(titles)
    else:
        for name, title in titles.items():
            echo(f"{name:<12} {title}")
    return 0
