"""The fields of requests: one list per route checks a request and describes it in the OpenAPI document."""

from __future__ import annotations

import re
from dataclasses import dataclass
from difflib import get_close_matches
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

from mavstack.http.bodies import RefusedError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

FieldType: TypeAlias = Literal["number", "integer", "string", "boolean", "array", "object", "value"]

_PYTHON_TYPES: Final[Mapping[str, type | tuple[type, ...]]] = MappingProxyType(
    {
        "number": (int, float),
        "integer": int,
        "string": str,
        "boolean": bool,
        "array": list,
        "object": dict,
        "value": (int, float, str),
    }
)
_WORDS: Final = MappingProxyType(
    {"true": True, "1": True, "yes": True, "false": False, "0": False, "no": False}
)
#: Characters of a text in a request, unless a field allows more.
MAX_TEXT: Final = 4096


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """A member of a JSON body, or of a query.

    Attributes:
        name: The name.
        type: The JSON type; "value": a number or a text.
        about: Its meaning, with the unit.
        required: True if a request without it is refused.
        default: The value if it is missing or null.
        minimum: The smallest number.
        maximum: The largest number.
        choices: The allowed texts; empty: any.
        max_length: The most characters of a text.
        pattern: A regular expression for the whole text; empty: any.
        example: A value for the documentation.
    """

    name: str
    type: FieldType = "number"
    about: str
    required: bool = False
    default: Any = None
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()
    max_length: int = MAX_TEXT
    pattern: str = ""
    example: Any = None

    def read(self, value: object) -> Any:  # noqa: ANN401 (its type is that of the field)
        """Return a checked value; raises `RefusedError` with what is wrong."""
        expected = _PYTHON_TYPES[self.type]
        if not isinstance(value, expected) or (isinstance(value, bool) and self.type != "boolean"):
            raise RefusedError(400, f"{self.name} must be {_articled(self.type)}, got {_shown(value)}")
        if isinstance(value, int | float) and not isinstance(value, bool):
            self._check_range(value)
        if isinstance(value, str):
            self._check_text(value)
        return float(value) if self.type == "number" and isinstance(value, int | float) else value

    def read_text(self, text: str) -> Any:  # noqa: ANN401
        """Return the value of a text, as a query has it; raises `RefusedError`."""
        if self.type == "boolean":
            if text.lower() not in _WORDS:
                raise RefusedError(400, f"{self.name} must be true or false, got {_shown(text)}")
            return _WORDS[text.lower()]
        if self.type in ("integer", "number"):
            try:
                return self.read(int(text) if self.type == "integer" else float(text))
            except (ValueError, OverflowError):
                raise RefusedError(
                    400, f"{self.name} must be {_articled(self.type)}, got {_shown(text)}"
                ) from None
        return self.read(text)

    def _check_range(self, value: float) -> None:
        try:
            finite = isfinite(value)
        except OverflowError:
            finite = False
        below = self.minimum is not None and value < self.minimum
        above = self.maximum is not None and value > self.maximum
        if not finite or below or above:
            limits = [f"at least {self.minimum:g}"] if self.minimum is not None else []
            limits += [f"at most {self.maximum:g}"] if self.maximum is not None else []
            raise RefusedError(
                400, f"{self.name} must be {' and '.join(limits) or 'finite'}, got {_shown(value)}"
            )

    def _check_text(self, value: str) -> None:
        if self.choices and value not in self.choices:
            raise RefusedError(
                400, f"{self.name} must be one of {', '.join(self.choices)}, got {_shown(value)}"
            )
        if len(value) > self.max_length:
            raise RefusedError(400, f"{self.name} is longer than {self.max_length} characters")
        if self.pattern and not re.fullmatch(self.pattern, value):
            raise RefusedError(400, f"{self.name} must fit {self.pattern}, got {_shown(value)}")

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of the value."""
        found: dict[str, Any] = {"description": self.about}
        if self.type == "value":
            found["type"] = ["number", "string"]
        else:
            found["type"] = self.type if self.required else [self.type, "null"]
        limits = {"minimum": self.minimum, "maximum": self.maximum, "default": self.default}
        found |= {key: value for key, value in limits.items() if value is not None}
        if self.choices:
            found["enum"] = [*self.choices] if self.required else [*self.choices, None]
        if self.type == "string":
            found["maxLength"] = self.max_length
        if self.pattern:
            found["pattern"] = f"^{self.pattern}$"
        if self.example is not None:
            found["examples"] = [self.example]
        return found


def read_fields(fields: Sequence[Field], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the checked values of a JSON body.

    Args:
        fields: The fields that the body may have.
        values: The members of the body.

    Returns:
        A value for each field; null is the default.

    Raises:
        RefusedError: A member is unknown, missing or not valid.
    """
    return _read(fields, values, from_text=False)


def read_query(fields: Sequence[Field], values: Mapping[str, str]) -> dict[str, Any]:
    """Return the checked values of a query; see `read_fields`."""
    return _read(fields, values, from_text=True)


def _read(fields: Sequence[Field], values: Mapping[str, Any], *, from_text: bool) -> dict[str, Any]:
    known = [each.name for each in fields]
    for name in values:
        if name not in known:
            raise RefusedError(400, _unknown(name, known))
    found: dict[str, Any] = {}
    for each in fields:
        value = values.get(each.name)
        if value is None and each.required:
            raise RefusedError(400, f"{each.name} is missing: {each.about}")
        if value is None:
            found[each.name] = each.default
        else:
            found[each.name] = each.read_text(value) if from_text else each.read(value)
    return found


def _unknown(name: str, known: Sequence[str]) -> str:
    close = get_close_matches(name, known, 1)
    hint = (
        f"did you mean {close[0]}?"
        if close
        else f"there are {', '.join(known)}"
        if known
        else "the request takes none"
    )
    return f"there is no field {_shown(name)}: {hint}"


def _articled(kind: str) -> str:
    if kind == "value":
        return "a number or a string"
    return f"an {kind}" if kind[0] in "aeiou" else f"a {kind}"


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:59]}…"
