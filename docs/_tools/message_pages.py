"""The message reference: pages with the messages, commands and enums of each official dialect.

A page lists only what its definition file defines itself; included dialects are linked. Tables are written
as HTML, since parsing thousands of Markdown tables would make up most of the build time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from html import escape
from typing import TYPE_CHECKING

from mavstack import Dialect
from mavstack.dialects.names import class_name
from mavstack.dialects.tables import official_names

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.dialects.model import (
        EnumDefinition,
        EnumEntry,
        EnumParam,
        FieldDefinition,
        MessageDefinition,
        Replacement,
    )

#: A dialect with more messages and enum entries than this has several pages.
MAX_ON_ONE_PAGE = 150
COMMANDS = "MAV_CMD"
_TEST_DIALECTS = ("test", "python_array_test")


@dataclass(frozen=True)
class Page:
    """A generated page: its dialect, its title in the navigation, its path below docs/ and its Markdown."""

    dialect: str
    title: str
    path: str
    text: str


@dataclass(frozen=True)
class _Parts:
    """The definitions of one dialect, by part of the reference."""

    messages: tuple[MessageDefinition, ...]
    commands: tuple[EnumEntry, ...]
    enums: tuple[EnumDefinition, ...]

    @property
    def is_large(self) -> bool:
        entries = sum(len(enum.entries) for enum in self.enums)
        return len(self.messages) + len(self.commands) + entries > MAX_ON_ONE_PAGE


def pages() -> Iterator[Page]:
    """Yield the pages of all official dialects."""
    for name in ordered_names():
        parts = _parts(name)
        if not parts.is_large:
            yield Page(name, name, f"messages/{name}.md", _small_page(name, parts))
            continue
        yield Page(name, "Messages", f"messages/{name}/index.md", _messages_page(name, parts))
        if parts.commands:
            yield Page(name, "Commands", f"messages/{name}/commands.md", _commands_page(name, parts))
        yield Page(name, "Enums", f"messages/{name}/enums.md", _enums_page(name, parts))


def navigation(made: Iterable[Page]) -> list[object]:
    """Return the entries of the navigation for the pages."""
    entries: dict[str, list[dict[str, str]]] = {}
    for page in made:
        entries.setdefault(page.dialect, []).append({page.title: page.path})
    return [found[0] if len(found) == 1 else {name: found} for name, found in entries.items()]


def ordered_names() -> list[str]:
    """Return the names of the official dialects: the included ones first, those for tests last."""
    first = ["common", "ardupilotmega", "standard", "minimal", "development", "all"]
    others = sorted((name for name in official_names() if name not in first), key=str.lower)
    others.sort(key=_TEST_DIALECTS.__contains__)
    return [*first, *others]


def render_index() -> str:
    """Return the table of dialects."""
    rows = []
    for name in ordered_names():
        dialect, parts = Dialect.load(name), _parts(name)
        includes = ", ".join(f"[{item.name}]({_page_of(item.name)})" for item in dialect.includes) or "none"
        rows.append(
            f"| [{name}]({_page_of(name)}) | {len(parts.messages)} | {len(parts.commands)} "
            f"| {len(parts.enums)} | {len(dialect)} | {includes} |"
        )
    head = "| dialect | messages | commands | enums | messages with includes | includes |"
    return "\n".join([head, "|---|--:|--:|--:|--:|---|", *rows])


@cache
def _parts(name: str) -> _Parts:
    definition = Dialect.load(name).own_definition
    commands = tuple(entry for enum in definition.enums if enum.name == COMMANDS for entry in enum.entries)
    return _Parts(
        tuple(sorted(definition.messages, key=lambda message: message.id)),
        tuple(sorted(commands, key=lambda entry: entry.value)),
        tuple(
            sorted((enum for enum in definition.enums if enum.name != COMMANDS), key=lambda enum: enum.name)
        ),
    )


# Pages


def _small_page(name: str, parts: _Parts) -> str:
    lines = [f"# Dialect {name}", "", _introduction(name), ""]
    if parts.messages:
        lines += ["## Messages", "", *_messages(name, parts)]
    if parts.commands:
        lines += ["## Commands", "", *_commands(name, parts)]
    if parts.enums:
        lines += ["## Enums", "", *_enums(name, parts)]
    return "\n".join(lines)


def _messages_page(name: str, parts: _Parts) -> str:
    others = [f"[commands]({name}/commands.md)"] * bool(parts.commands) + [f"[enums]({name}/enums.md)"]
    links = ", ".join(item.replace(f"({name}/", "(") for item in others)
    lines = [f"# Messages of {name}", "", _introduction(name, "../"), "", f"Other pages: {links}.", ""]
    return "\n".join([*lines, *_messages(name, parts, "## ")])


def _commands_page(name: str, parts: _Parts) -> str:
    text = (
        f"The commands (MAV_CMD) that the dialect {name} defines, for COMMAND_LONG, COMMAND_INT and mission "
        "items. Send one with `component.command(common.MavCmd.NAME, …)`."
    )
    return "\n".join([f"# Commands of {name}", "", text, "", *_commands(name, parts, "## ", "../../")])


def _enums_page(name: str, parts: _Parts) -> str:
    text = f"The enums that the dialect {name} defines or extends; its commands have a page of their own."
    return "\n".join([f"# Enums of {name}", "", text, "", *_enums(name, parts, "## ", "../../")])


def _introduction(name: str, up: str = "") -> str:
    dialect = Dialect.load(name)
    parts = _parts(name)
    includes = ", ".join(f"[{item.name}]({up}{_page_of(item.name)})" for item in dialect.includes)
    included = f" It includes {includes}." if includes else ""
    own = f"{len(parts.messages)} messages, {len(parts.commands)} commands and {len(parts.enums)} enums"
    use = f"`from mavstack.dialects import {dialect.module_name.rpartition('.')[2]}`"
    return f"The dialect `{name}` defines {own} itself.{included} In Python: {use}."


# Messages


def _messages(name: str, parts: _Parts, heading: str = "### ", base: str = "../") -> Iterator[str]:
    for message in parts.messages:
        yield f"{heading}{message.name} {{ #{message.name} }}"
        yield ""
        yield _message(name, message, base)
        yield ""


def _message(name: str, message: MessageDefinition, base: str) -> str:
    module = name.lower()
    size = f"{message.base_length} bytes"
    if message.length != message.base_length:
        size += f" ({message.length} with extensions)"
    facts = (
        f'<p class="facts">id <b>{message.id}</b> · CRC_EXTRA <b>{message.crc_extra}</b> · {size} · '
        f"<code>{module}.{class_name(message.name)}</code></p>"
    )
    rows = [_field_row(name, field, base) for field in message.fields]
    text = escape(message.description)
    marks = _marks(message.deprecated, message.superseded, wip=message.wip)
    return f"<p>{text}</p>{marks}{facts}" + _table(("field", "type", "unit or enum", "notes"), rows)


def _field_row(name: str, field: FieldDefinition, base: str) -> tuple[str, ...]:
    kind = field.type + (f"[{field.array_length}]" if field.array_length else "")
    unit = _enum_link(name, field.enum, base) if field.enum else escape(field.units)
    if field.multiplier:
        unit += f" &times; {escape(field.multiplier)}"
    notes = [
        "extension" if field.extension else "",
        f"invalid: {escape(field.invalid)}" if field.invalid else "",
        f"default: {escape(field.default)}" if field.default else "",
        _range(field.minimum, field.maximum),
        "instance" if field.instance else "",
        escape(field.description),
    ]
    return f"<code>{_breakable(field.name)}</code>", kind, unit, "; ".join(filter(None, notes))


# Commands


def _commands(name: str, parts: _Parts, heading: str = "### ", base: str = "../") -> Iterator[str]:
    for entry in parts.commands:
        yield f"{heading}{entry.name} {{ #{entry.name} }}"
        yield ""
        yield _command(name, entry, base)
        yield ""


def _command(name: str, entry: EnumEntry, base: str) -> str:
    member = entry.name.removeprefix("MAV_CMD_")
    notes = [
        "a mission item only" if entry.mission_only else "",
        "with a location" if entry.has_location else "",
        "a destination" if entry.is_destination else "",
    ]
    places = " · ".join(filter(None, notes))
    facts = (
        f'<p class="facts">command <b>{entry.value}</b> · <code>{name.lower()}.MavCmd.{escape(member)}</code>'
        f"{' · ' + places if places else ''}</p>"
    )
    text = f"<p>{escape(entry.description)}</p>" if entry.description else ""
    rows = [_param_row(name, param, base) for param in entry.params if not _is_unused(param)]
    table = _table(("param", "label", "unit or enum", "notes"), rows) if rows else "<p>No parameters.</p>"
    return text + _marks(entry.deprecated, entry.superseded, wip=entry.wip) + facts + table


def _is_unused(param: EnumParam) -> bool:
    return param.reserved or not (param.label or param.description or param.enum or param.units)


def _param_row(name: str, param: EnumParam, base: str) -> tuple[str, ...]:
    unit = _enum_link(name, param.enum, base) if param.enum else escape(param.units)
    notes = [
        f"default: {escape(param.default)}" if param.default else "",
        _range(param.minimum, param.maximum),
        escape(param.description),
    ]
    return str(param.index), escape(param.label), unit, "; ".join(filter(None, notes))


# Enums


def _enums(name: str, parts: _Parts, heading: str = "### ", base: str = "../") -> Iterator[str]:
    for enum in parts.enums:
        yield f"{heading}{enum.name} {{ #{enum.name} }}"
        yield ""
        yield _enum(name, enum, base)
        yield ""


def _enum(name: str, enum: EnumDefinition, base: str) -> str:
    dialect = Dialect.load(name)
    origin = dialect.enum_files[enum.name][0].name
    kind = "bitmask" if enum.bitmask else "enum"
    made = dialect.enum_class(enum.name)
    facts = f'<p class="facts">{kind} · <code>{name.lower()}.{made.__name__}</code>'
    if origin != name:
        link = f"{_html_path(_enum_page(origin), base)}#{enum.name}"
        facts += f' · more entries of the enum in <a href="{link}">{origin}</a>'
    members = {int(member): member_name for member_name, member in made.__members__.items()}
    table = _table(
        ("value", "entry", "in Python", "notes"), [_entry_row(entry, members) for entry in enum.entries]
    )
    text = f"<p>{escape(enum.description)}</p>" if enum.description else ""
    marks = _marks(enum.deprecated, enum.superseded, wip=enum.wip)
    return f"{text}{marks}{facts}</p>{table}"


def _entry_row(entry: EnumEntry, members: dict[int, str]) -> tuple[str, ...]:
    marks = _marks(entry.deprecated, entry.superseded, wip=entry.wip, inline=True)
    notes = " ".join(filter(None, (escape(entry.description), marks)))
    python = f"<code>{_breakable(members[entry.value])}</code>" if entry.value in members else ""
    return str(entry.value), f"<code>{_breakable(entry.name)}</code>", python, notes


# Parts of both


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """Return an HTML table; columns at its end that are empty are left out."""
    width = max((index + 1 for row in rows for index, cell in enumerate(row) if cell), default=len(head))
    lines = ["<table><thead><tr>", *(f"<th>{title}</th>" for title in head[:width]), "</tr></thead><tbody>"]
    for row in rows:
        lines += ["<tr>", *(f"<td>{cell}</td>" for cell in row[:width]), "</tr>"]
    return " ".join([*lines, "</tbody></table>"])


def _breakable(name: str) -> str:
    """Return a name that a browser may break behind each underscore."""
    return name.replace("_", "_<wbr>")


def _range(minimum: float | None, maximum: float | None) -> str:
    if minimum is None and maximum is None:
        return ""
    if maximum is None:
        return f"≥ {minimum:g}"
    return f"≤ {maximum:g}" if minimum is None else f"{minimum:g} to {maximum:g}"


def _marks(
    deprecated: Replacement | None, superseded: Replacement | None, *, wip: bool, inline: bool = False
) -> str:
    marks = ["Work in progress: may change."] if wip else []
    for word, mark in (("Deprecated", deprecated), ("Superseded", superseded)):
        if mark is not None:
            since = f" since {mark.since}" if mark.since else ""
            by = f"; use {mark.replaced_by}" if mark.replaced_by else ""
            marks.append(f"{word}{since}{by}. {mark.description}".strip())
    text = escape(" ".join(marks))
    return text if inline or not text else f'<p class="mark">{text}</p>'


def _page_of(name: str) -> str:
    """Return the path of a dialect's first page, relative to messages/."""
    return f"{name}/index.md" if _parts(name).is_large else f"{name}.md"


def _enum_page(name: str) -> str:
    return f"{name}/enums.md" if _parts(name).is_large else f"{name}.md"


def _enum_link(name: str, enum: str, base: str) -> str:
    """Return a link to an enum, in the first dialect of the family that defines it."""
    files = Dialect.load(name).enum_files.get(enum)
    if not files:
        return escape(enum)
    origin = files[0].name
    if enum == COMMANDS:
        large = _parts(origin).is_large
        path = f"{origin}/commands.md" if large else f"{origin}.md"
        return f'<a href="{_html_path(path, base)}">{enum}</a>'
    return f'<a href="{_html_path(_enum_page(origin), base)}#{enum}">{_breakable(enum)}</a>'


def _html_path(path: str, base: str) -> str:
    """Return the relative address of a page; `base` leads from the page that links to it to messages/."""
    return base + path.removesuffix("index.md").removesuffix(".md").rstrip("/") + "/"
