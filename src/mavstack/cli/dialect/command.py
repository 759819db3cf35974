"""`mav dialect`: list, show, check, compare and import message definitions, and generate modules of them."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import echo, echo_json, echo_text
from mavstack.dialects.lookup import find_dialect

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.dialects.checks import Problem

EXAMPLES: Final = """\
examples:
  mav dialect list                                  # the official dialects
  mav dialect show common                           # messages and enums of a dialect
  mav dialect show common ATTITUDE                  # one message, by its name or id
  mav dialect show ardupilotmega MAV_CMD_NAV_TAKEOFF --json
  mav dialect check mine.xml                        # errors and warnings with line numbers
  mav dialect check mine.xml --against old.xml      # the same, and changes that break the wire
  mav dialect diff common mine.xml                  # differences, and which break the wire format
  mav dialect import official.xml -o mine.xml       # the facts of a definition, without its prose
  mav dialect stubs mine.xml -o src/mypackage       # a module with types for editors: import mypackage.mine
  mav dialect stubs mine.xml -o src/mypackage --check   # for the build: fail if the module is out of date
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions and their arguments."""
    add = Actions(parser, "dialect", EXAMPLES).add
    list_parser = add("list", "list the official dialects", _list)
    show = add("show", "show a dialect, or a message, enum or enum entry of it", _show)
    show.add_argument("dialect", metavar="NAME|FILE.xml", help="official dialect or definition file")
    show.add_argument(
        "item",
        metavar="MESSAGE|ID|ENUM|ENTRY",
        nargs="?",
        help="message, message id, enum or enum entry (default: the contents of the dialect)",
    )
    check = add("check", "check a definition file", _check)
    check.add_argument("file", metavar="FILE.xml", help="definition file")
    check.add_argument(
        "--against", metavar="OLD.xml", help="older version: changes that break the wire are errors"
    )
    check.add_argument("--strict", action="store_true", help="fail also for warnings")
    diff = add("diff", "compare two dialects", _diff)
    diff.add_argument("old", metavar="OLD", help="official dialect or definition file")
    diff.add_argument("new", metavar="NEW", help="official dialect or definition file")
    diff.add_argument("--prose", action="store_true", help="also compare descriptions")
    diff.add_argument(
        "--exit-code", action="store_true", help="exit with 1 if a difference breaks the wire format"
    )
    for parser_with_json in (list_parser, show, check, diff):
        parser_with_json.add_argument("--json", action="store_true", help="print JSON")
    import_parser = add("import", "write the facts of a definition file to a new file", _import)
    import_parser.add_argument("file", metavar="OFFICIAL.xml", help="definition file to read")
    import_parser.add_argument(
        "-o",
        "--output",
        metavar="FILE.xml",
        required=True,
        help="file to write; descriptions that it already has are kept",
    )
    stubs = add("stubs", "write a Python module and its types for a definition file", _stubs)
    stubs.add_argument("file", metavar="FILE.xml", help="definition file")
    stubs.add_argument(
        "-o",
        "--output",
        metavar="DIR",
        required=True,
        help="folder of the module, its stub and a copy of the definition file",
    )
    stubs.add_argument(
        "--check", action="store_true", help="write nothing; exit with 1 if a file is out of date"
    )


def _list(arguments: Namespace) -> int:
    from mavstack.cli.dialect.pages import dialect_facts, dialects_page
    from mavstack.dialects import Dialect
    from mavstack.dialects.tables import official_names

    facts = [dialect_facts(Dialect.load(name)) for name in official_names()]
    _print(facts, dialects_page(facts), arguments)
    return 0


def _show(arguments: Namespace) -> int:
    from mavstack.cli.dialect.pages import contents_page, dialect_facts, find, plain

    dialect = find_dialect(arguments.dialect)
    if arguments.item is None:
        contents = {
            **dialect_facts(dialect),
            "message_names": list(dialect.names),
            "enum_names": list(dialect.enums),
        }
        _print(contents, contents_page(dialect), arguments)
        return 0
    found = find(dialect, arguments.item)
    _print(plain(found.facts), found.page, arguments)
    return 0


def _check(arguments: Namespace) -> int:
    from dataclasses import asdict

    problems = _problems(arguments)
    counts = Counter(problem.severity for problem in problems)
    errors, warnings = counts["error"], counts["warning"]
    if arguments.json:
        echo_json([asdict(problem) for problem in problems])
    else:
        for problem in problems:
            echo(str(problem))
    failed = errors or (arguments.strict and warnings)
    if failed or not arguments.json:
        notes = f", {counts['note']} notes" if counts["note"] else ""
        summary = f"{arguments.file}: {errors} errors, {warnings} warnings{notes}"
        echo(f"mav dialect: {summary}" if failed else summary, error=bool(failed))
    return 1 if failed else 0


def _problems(arguments: Namespace) -> list[Problem]:
    """Return the problems of a file, and if it loads those of its names and of its changes."""
    from mavstack.codegen.checks import reserved_names
    from mavstack.dialects.checks import Problem, check_against, check_file
    from mavstack.dialects.includes import collect

    problems = check_file(arguments.file)
    if any(problem.severity == "error" for problem in problems):
        return problems
    names = reserved_names(collect(arguments.file).definition)
    problems += [Problem("note", text, arguments.file, line or None) for line, text in names]
    if arguments.against:
        problems += check_against(arguments.file, find_dialect(arguments.against).definition)
    return problems


def _diff(arguments: Namespace) -> int:
    from dataclasses import asdict

    from mavstack.dialects.compare import compare

    old, new = (find_dialect(name).definition for name in (arguments.old, arguments.new))
    changes = compare(old, new, prose=arguments.prose)
    broken = sum(change.breaks_wire for change in changes)
    if arguments.json:
        echo_json([asdict(change) for change in changes])
    else:
        for change in changes:
            echo(str(change))
        summary = f"{len(changes)} differences, {broken} of them break the wire format"
        echo(summary if changes else "no differences")
    return 1 if broken and arguments.exit_code else 0


def _import(arguments: Namespace) -> int:
    from mavstack.dialects.importer import import_file

    target = Path(arguments.output)
    if target.exists() and target.samefile(arguments.file):
        raise UsageError(f"{target} is the input file; name another output file with -o")
    definition = import_file(arguments.file, arguments.output)
    echo(f"{target}: {len(definition.messages)} messages, {len(definition.enums)} enums")
    return 0


def _stubs(arguments: Namespace) -> int:
    from mavstack.dialects.file_modules import outdated_files, write_dialect_module

    if arguments.check:
        outdated = outdated_files(arguments.file, arguments.output)
        for file in outdated:
            echo(f"mav dialect: out of date: {file}", error=True)
        return 1 if outdated else 0
    for file in write_dialect_module(arguments.file, arguments.output):
        echo(str(file))
    return 0


def _print(facts: object, page: str, arguments: Namespace) -> None:
    if arguments.json:
        echo_json(facts)
    else:
        echo_text(f"{page}\n")
