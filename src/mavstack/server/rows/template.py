"""Templates of lines of text with separated values: which column is which field of which message.

    time:s,lat:deg,lon:deg,alt:m*0.001     names with units and factors
    $IMU,roll:deg,pitch:deg                a line that begins with `$IMU` is the message IMU
    $GPS,lat,lon|$IMU,roll,pitch           several messages
    temperature;_;pressure                 `_` leaves a column out; the first of , ; tab space separates

The pages of the station read the same templates (`web/src/lib/rows/template.ts`);
`web/src/lib/rows/template-cases.json` tests both.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Final, NoReturn

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.server.rows.frame_fields import Value

#: The message name of a template that does not begin with a constant.
DEFAULT_MESSAGE: Final = "ROW"
MAX_COLUMNS: Final = 128
_SEPARATORS: Final = (",", ";", "\t", " ")
_NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")
_CONSTANT: Final = re.compile(r"\$[A-Za-z0-9_]{1,31}")
_NUMBER: Final = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


@dataclass(frozen=True, slots=True)
class Column:
    """A named column.

    Attributes:
        name: The name of the field.
        unit: The unit as text; empty: none.
        factor: The number in the line times this is the value.
    """

    name: str
    unit: str = ""
    factor: float = 1.0


@dataclass(frozen=True, slots=True)
class RowTemplate:
    """The template of one message.

    Attributes:
        message: The name of the message.
        constant: The word that begins the line; None: there is none.
        separator: The character between two columns.
        columns: The columns; None: one that is left out.
    """

    message: str
    constant: str | None
    separator: str
    columns: tuple[Column | None, ...]


@dataclass(frozen=True, slots=True)
class Row:
    """The values of a line or frame by their names.

    Attributes:
        message: The name of the message.
        fields: Numbers, texts where there is no number, and arrays of numbers.
        data: The bytes of a frame that a script reads; None: there are none.
    """

    message: str
    fields: Mapping[str, Value]
    data: bytes | None = None


def parse_templates(text: str) -> tuple[RowTemplate, ...]:
    """Parse templates.

    Args:
        text: One template, or several with `|` between them.

    Returns:
        The templates in their order.

    Raises:
        InvalidArgumentError: A template is malformed; the text says what is wrong.
    """
    templates = tuple(_parse_template(part.strip()) for part in text.split("|"))
    if len({each.constant for each in templates}) < len(templates):
        _refuse(text, "two templates begin in the same way")
    return templates


def parse_row(templates: Sequence[RowTemplate], line: str) -> Row | None:
    """Return the row of a line, or None if no template fits."""
    for template in templates:
        words = _split(line.strip(), template.separator)
        if template.constant is not None and words.pop(0) != template.constant:
            continue
        if len(words) == len(template.columns):
            return Row(template.message, _fields(template, words))
    return None


def _parse_template(text: str) -> RowTemplate:
    if not text:
        _refuse(text, "it names the columns, such as time:s,lat:deg,lon:deg")
    separator = next((each for each in _SEPARATORS if each in text), ",")
    words = _split(text, separator)
    constant = words.pop(0) if words[0].startswith("$") else None
    if constant is not None and not _CONSTANT.fullmatch(constant):
        _refuse(text, f"{constant} is not a constant such as $GPS")
    if not 1 <= len(words) <= MAX_COLUMNS:
        _refuse(text, f"it has 1 to {MAX_COLUMNS} columns, got {len(words)}")
    columns = tuple(_parse_column(text, word) for word in words)
    names = [column.name for column in columns if column is not None]
    if not names:
        _refuse(text, "no column has a name")
    repeated = next((name for index, name in enumerate(names) if name in names[:index]), None)
    if repeated is not None:
        _refuse(text, f"the column {repeated} is named twice")
    message = DEFAULT_MESSAGE if constant is None else constant[1:]
    return RowTemplate(message, constant, separator, columns)


def _parse_column(text: str, word: str) -> Column | None:
    if word == "_":
        return None
    rest, has_factor, factor = word.partition("*")
    name, _, unit = rest.partition(":")
    if not _NAME.fullmatch(name) or "*" in factor or ":" in unit:
        _refuse(text, f"{word!r} is not a column such as alt, alt:m or alt:m*0.001")
    if has_factor and not _NUMBER.fullmatch(factor):
        _refuse(text, f"the factor of {name} must be a number, got {factor!r}")
    return Column(name, unit, float(factor) if has_factor else 1.0)


def _split(text: str, separator: str) -> list[str]:
    # Columns that are aligned with spaces are separated by several spaces.
    words = re.split(" +", text) if separator == " " else text.split(separator)
    return [word.strip() for word in words]


def _fields(template: RowTemplate, words: Sequence[str]) -> dict[str, float | str]:
    fields: dict[str, float | str] = {}
    for column, word in zip(template.columns, words, strict=True):
        if column is None or not word:
            continue
        value = float(word) * column.factor if _NUMBER.fullmatch(word) else word
        if isinstance(value, str) or isfinite(value):
            fields[column.name] = value
    return fields


def _refuse(text: str, problem: str) -> NoReturn:
    raise InvalidArgumentError(f"invalid template {text[:60]!r}: {problem}")
