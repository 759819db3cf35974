"""Reading JSON files from any source, with the key of the value in every error."""

from __future__ import annotations

import json
from math import inf, isfinite, nan
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import PlanFileError
from mavstack.files.plans.parsing import shown

if TYPE_CHECKING:
    from typing import Self

#: Maximum number of objects and arrays, and of all values, in a document, since a value in memory takes up to
#: a hundred times the size of its text. The largest possible plans have less than 450,000 and 2,900,000.
MAX_CONTAINERS: Final = 750_000
MAX_VALUES: Final = 3_000_000
_WORDS: Final = {"nan": nan, "inf": inf, "-inf": -inf}


class JsonValue:
    """A value in a JSON document, and its path."""

    __slots__ = ("name", "path", "value")

    def __init__(self, value: object, name: str = "", path: str = "") -> None:
        self.value = value
        self.name = name
        self.path = path

    @classmethod
    def parse(cls, text: str, name: str = "") -> Self:
        """Return the root of a document."""
        containers = text.count("{") + text.count("[")
        if containers > MAX_CONTAINERS or containers + text.count(",") > MAX_VALUES:
            raise PlanFileError("its JSON holds more values than any plan has", name)
        try:
            return cls(json.loads(text), name)
        except RecursionError:
            raise PlanFileError("its JSON is nested too deeply", name) from None
        except json.JSONDecodeError as error:
            problem = f"it is not JSON: {error.msg} (column {error.colno})"
            raise PlanFileError(problem, name, f"line {error.lineno}") from None
        except ValueError:  # the document contains a number with thousands of digits
            raise PlanFileError("it holds a number that is too long to be one", name) from None

    def wrong(self, problem: str) -> PlanFileError:
        """Return the error for a problem of this value."""
        return PlanFileError(problem, self.name, self.path)

    def find(self, key: str) -> JsonValue | None:
        """Return the value of a key; None if there is none."""
        if not isinstance(self.value, dict):
            raise self.wrong(f"is {shown(self.value)} where an object must be")
        if key not in self.value:
            return None
        return JsonValue(self.value[key], self.name, f"{self.path}.{key}" if self.path else key)

    def get(self, key: str) -> JsonValue:
        """Return the value of a key; raise if there is none."""
        found = self.find(key)
        if found is None:
            raise self.wrong(f"has no {key!r}")
        return found

    def elements(self, length: int | None = None) -> list[JsonValue]:
        """Return the elements of an array, of `length` elements unless it is None."""
        if not isinstance(self.value, list):
            raise self.wrong(f"is {shown(self.value)} where an array must be")
        if length is not None and len(self.value) != length:
            raise self.wrong(f"has {len(self.value)} values instead of {length}")
        return [
            JsonValue(value, self.name, f"{self.path}[{index}]") for index, value in enumerate(self.value)
        ]

    def number(self) -> float:
        """Return a number; null means NaN, as in QGC's files, and a number too large is infinite."""
        value = self.value
        if value is None:
            return nan
        if isinstance(value, str) and value in _WORDS:
            return _WORDS[value]
        if not isinstance(value, int | float) or isinstance(value, bool):
            raise self.wrong(f"is {shown(value)} where a number must be")
        try:
            return float(value)
        except OverflowError:
            return inf if value > 0 else -inf

    def finite(self) -> float:
        """Return a finite number."""
        value = self.number()
        if not isfinite(value):
            raise self.wrong(f"is {shown(self.value)} where a finite number must be")
        return value

    def integer(self, minimum: int, maximum: int) -> int:
        """Return a whole number in a range."""
        value = self.finite()
        if value != int(value) or not minimum <= value <= maximum:
            raise self.wrong(f"is {shown(self.value)}, not a whole number between {minimum} and {maximum}")
        return int(value)

    def text(self) -> str:
        """Return a string."""
        if not isinstance(self.value, str):
            raise self.wrong(f"is {shown(self.value)} where a text must be")
        return self.value

    def flag(self) -> bool:
        """Return a boolean; some programs write 0 and 1."""
        if isinstance(self.value, bool) or self.value in (0, 1):
            return bool(self.value)
        raise self.wrong(f"is {shown(self.value)} where true or false must be")

    def numbers(self, count: int) -> tuple[float, ...]:
        """Return an array of `count` numbers."""
        return tuple(element.number() for element in self.elements(count))


def as_json(value: float) -> Any:  # noqa: ANN401 (a number, a word or None)
    """Return a number as JSON can hold it: null for NaN, strings for infinities, 16 rather than 16.0."""
    if value != value:
        return None
    if not isfinite(value):
        return "inf" if value > 0 else "-inf"
    return int(value) if value == int(value) and abs(value) < 1e15 and str(value) != "-0.0" else value
