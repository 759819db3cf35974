"""Checks of a definition file, with a list of problems and their lines.

An error prevents the file from loading; only the first one is reported. A warning is a construct that loads,
but is probably unintended or not accepted by other readers of definition files.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from mavstack.dialects.allocation import id_warnings
from mavstack.dialects.compare import compare
from mavstack.dialects.dialect import Dialect
from mavstack.dialects.includes import collect, collect_as_written, foreign_enums, included_first
from mavstack.dialects.merging import merge_enums
from mavstack.dialects.names import class_name
from mavstack.dialects.xml_reader import Element, read_bytes, read_tree
from mavstack.errors import DialectError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects.model import DialectDefinition, EnumDefinition, MessageDefinition

_STATUS_ELEMENTS = frozenset({"wip", "deprecated", "superseded", "description"})
_CHILDREN = {
    "mavlink": frozenset({"include", "version", "dialect", "enums", "messages"}),
    "enums": frozenset({"enum"}),
    "enum": _STATUS_ELEMENTS | {"entry"},
    "entry": _STATUS_ELEMENTS | {"param"},
    "messages": frozenset({"message"}),
    "message": _STATUS_ELEMENTS | {"field", "extensions"},
    "field": frozenset({"description"}),
    "wip": frozenset({"description"}),
    "deprecated": frozenset({"description"}),
    "superseded": frozenset({"description"}),
}
_PLAN_FLAGS = {"mission", "fence", "rally", "command", "missionOnly"}
_VALUE_ATTRIBUTES = {
    "units",
    "multiplier",
    "instance",
    "enum",
    "increment",
    "minValue",
    "maxValue",
    "default",
}
_ATTRIBUTES = {
    "enum": frozenset({"name", "bitmask"}),
    "entry": frozenset({"name", "value", "hasLocation", "hasAltitudeOnly", "isDestination"} | _PLAN_FLAGS),
    "param": frozenset({"index", "label", "decimalPlaces", "reserved"} | _VALUE_ATTRIBUTES),
    "message": frozenset({"id", "name"}),
    "field": frozenset({"type", "name", "print_format", "display", "invalid"} | _VALUE_ATTRIBUTES),
    "wip": frozenset({"since"}),
    "deprecated": frozenset({"since", "replaced_by", "remove_on_date"}),
    "superseded": frozenset({"since", "replaced_by"}),
}


@dataclass(frozen=True, slots=True)
class Problem:
    """One error, warning or note about a definition file; a note needs no change of the file."""

    severity: Literal["error", "warning", "note"]
    text: str
    path: str
    line: int | None = None

    def __str__(self) -> str:
        location = self.path if self.line is None else f"{self.path}:{self.line}"
        return f"{location}: {self.severity}: {self.text}"


def check_file(path: str) -> list[Problem]:
    """Check a definition file; of its includes only errors, and enums of files that they do not include.

    Args:
        path: Path of the XML file.

    Returns:
        The problems: one error, or any number of warnings.
    """
    try:
        source = collect_as_written(path)
        tree = read_tree(read_bytes(path), path)
    except DialectError as error:
        return [Problem("error", error.problem, error.path or path, error.line)]
    problem = _load_problem(path)
    if problem is not None:
        return [problem]
    enums = merge_enums([item.definition for item in included_first(source)])
    warnings = [
        *_unknown(tree),
        *_messages(source.definition),
        *_enums(source.definition, enums),
        *id_warnings(source.definition),
    ]
    foreign = [
        Problem(
            "warning",
            f"{use.field} uses the enum {use.enum} of a file that is not included here: "
            "this file cannot be used alone",
            use.path,
            use.line or None,
        )
        for use in foreign_enums(source)
    ]
    return foreign + [Problem("warning", text, path, line or None) for line, text in sorted(warnings)]


def check_against(path: str, old: DialectDefinition) -> list[Problem]:
    """Compare a definition file with an older version of it.

    Args:
        path: Path of the XML file, which loads.
        old: The older version, with its includes.

    Returns:
        An error for each change that breaks the wire, a note for each other one.
    """
    lines = {message.name: message.line for message in collect(path).definition.messages}
    problems = []
    for change in compare(old, Dialect.from_xml(path).definition):
        message = change.subject.partition(" ")[2].partition(".")[0]
        text = f"{change}: peers with the older version cannot read it" if change.breaks_wire else str(change)
        severity: Literal["error", "note"] = "error" if change.breaks_wire else "note"
        problems.append(Problem(severity, text, path, lines.get(message)))
    return problems


def _load_problem(path: str) -> Problem | None:
    """Return the problem that prevents any class of a dialect from being created; None if there is none."""
    try:
        dialect = Dialect.from_xml(path)
        for message in dialect:
            message().to_dict()
        for enum in dialect.enums.values():
            enum.definition()
        _ = dialect.core_dialect
    except DialectError as error:
        return Problem("error", error.problem, error.path or path, error.line)
    except Exception as error:  # noqa: BLE001 (a check reports each failure)
        return Problem("error", f"it cannot be loaded: {type(error).__name__}: {error}", path)
    return None


def _unknown(element: Element) -> Iterator[tuple[int, str]]:
    """Yield the elements and attributes that are not in the schema."""
    known = _ATTRIBUTES.get(element.tag, frozenset())
    for name in element.attributes:
        if name not in known and ":" not in name:
            yield element.line, f"<{element.tag}> has an unknown attribute {name!r}"
    for child in element.children:
        if child.tag in _CHILDREN.get(element.tag, frozenset()):
            yield from _unknown(child)
        else:
            yield child.line, f"unknown element <{child.tag}> in <{element.tag}>"


def _messages(definition: DialectDefinition) -> Iterator[tuple[int, str]]:
    classes: dict[str, str] = {}
    for message in definition.messages:
        other = classes.setdefault(class_name(message.name), message.name)
        if other != message.name:
            yield message.line, f"{message.name} and {other} have the same class name"
        if not message.description:
            yield message.line, f"message {message.name} has no description"
        yield from _fields(message)


def _fields(message: MessageDefinition) -> Iterator[tuple[int, str]]:
    for item in message.fields:
        if item.enum and not item.is_integer:
            yield (
                item.line,
                f"{message.name}.{item.name} is a {item.type} and cannot have the enum {item.enum}",
            )
        yield from _unit(item.units, f"{message.name}.{item.name}", item.line)
        if item.minimum is not None and item.maximum is not None and item.minimum > item.maximum:
            yield item.line, f"{message.name}.{item.name} has a minimum above its maximum"


def _enums(definition: DialectDefinition, known: dict[str, EnumDefinition]) -> Iterator[tuple[int, str]]:
    for enum in definition.enums:
        if not enum.entries:
            yield enum.line, f"enum {enum.name} has no entries"
        for entry in enum.entries:
            if entry.automatic:
                yield entry.line, f"{entry.name} has no value; {entry.value} is assumed"
            if enum.bitmask and entry.value.bit_count() > 1:
                yield entry.line, f"{entry.name} is in a bitmask, but {entry.value} is not a single bit"
            for param in entry.params:
                yield from _unit(param.units, f"param {param.index} of {entry.name}", entry.line)
                if param.enum and param.enum not in known:
                    yield entry.line, f"{entry.name} refers to the undefined enum {param.enum}"


def _unit(units: str, owner: str, line: int) -> Iterator[tuple[int, str]]:
    """Yield a unit that has line ends or other control characters, which generated code leaves out."""
    if not units.isprintable():
        yield line, f"the unit of {owner} has control characters: {units!a}"
