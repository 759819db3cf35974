"""The members of a JSON object that people write: read one by one, with errors that name their place."""

from __future__ import annotations

import re
from math import isfinite
from typing import TYPE_CHECKING, Any, Final, NoReturn

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Collection

_MISSING: Final = object()
_HEX: Final = re.compile(r"(?:\s*[0-9A-Fa-f]{2})*\s*", re.ASCII)
_NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}", re.ASCII)
MAX_SHOWN: Final = 40


class Members:
    """The members of one object.

    Args:
        value: The object.
        place: Where it is, such as `messages[0]`; empty: the whole.
    """

    def __init__(self, value: object, place: str = "") -> None:
        self.place = place
        if not isinstance(value, dict):
            refuse(place, "must be an object", value)
        self._values: dict[str, Any] = value
        self._known: list[str] = []

    def has(self, name: str) -> bool:
        """Return whether a member is there."""
        return self._take(name, None) is not None

    def place_of(self, name: str) -> str:
        """Return the place of a member."""
        return f"{self.place}.{name}" if self.place else name

    def integer(self, name: str, minimum: int, maximum: int, default: int | None = None) -> int:
        """Return a whole number between two limits."""
        value = self._take(name, default)
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int) or not minimum <= value <= maximum:
            self._refuse(name, f"must be a whole number from {minimum} to {maximum}", value)
        return value

    def number(self, name: str, default: float) -> float:
        """Return a finite number."""
        value = self._take(name, default)
        if isinstance(value, bool) or not isinstance(value, int | float) or not _is_finite(value):
            self._refuse(name, "must be a number", value)
        return float(value)

    def choice(self, name: str, choices: Collection[str], default: str | None = None) -> str:
        """Return one of several words."""
        value = self._take(name, default)
        if not isinstance(value, str) or value not in choices:
            self._refuse(name, f"must be one of {', '.join(choices)}", value)
        return value

    def text(self, name: str, maximum: int, default: str | None = None) -> str:
        """Return a text of limited length."""
        value = self._take(name, default)
        if not isinstance(value, str) or len(value) > maximum:
            self._refuse(name, f"must be a text of at most {maximum} characters", value)
        return value

    def name(self, name: str, default: str | None = None) -> str:
        """Return a name: a letter, and up to 31 letters, digits and _."""
        value = self._take(name, default)
        if not isinstance(value, str) or not _NAME.fullmatch(value):
            self._refuse(name, "must be a name of letters, digits and _", value)
        return value

    def hex_bytes(self, name: str, minimum: int, maximum: int, default: str | None = None) -> bytes:
        """Return bytes that are written in hexadecimal digits."""
        value = self._take(name, default)
        if not isinstance(value, str) or not _HEX.fullmatch(value):
            self._refuse(name, "must be bytes in hexadecimal digits such as aa55", value)
        found = bytes.fromhex("".join(value.split()))
        if not minimum <= len(found) <= maximum:
            self._refuse(name, f"must be {minimum} to {maximum} bytes", value)
        return found

    def children(self, name: str, maximum: int) -> list[Members]:
        """Return the objects of a list; a missing one is empty."""
        value = self._take(name, [])
        if not isinstance(value, list) or len(value) > maximum:
            self._refuse(name, f"must be a list of at most {maximum} objects", value)
        return [Members(each, f"{self.place_of(name)}[{index}]") for index, each in enumerate(value)]

    def child(self, name: str) -> Members:
        """Return an object."""
        return Members(self._take(name, _MISSING), self.place_of(name))

    def texts(self, name: str, maximum: int) -> dict[str, str]:
        """Return an object of texts; a missing one is empty."""
        value = self._take(name, {})
        if not isinstance(value, dict) or len(value) > maximum:
            self._refuse(name, f"must be an object of at most {maximum} texts", value)
        for key, text in value.items():
            if not isinstance(text, str):
                refuse(f"{self.place_of(name)}.{key[:MAX_SHOWN]}", "must be a text", text)
        return value

    def end(self) -> None:
        """Refuse members that were not read."""
        for name in self._values:
            if name not in self._known:
                self._refuse(name[:MAX_SHOWN], f"is not known here: there are {', '.join(self._known)}")

    def _take(self, name: str, default: object) -> Any:  # noqa: ANN401 (of JSON)
        if name not in self._known:
            self._known.append(name)
        value = self._values.get(name)
        if value is None and (default is None or default is _MISSING):
            return None
        return default if value is None else value

    def _refuse(self, name: str, problem: str, value: object = _MISSING) -> NoReturn:
        refuse(self.place_of(name), problem, value)


def refuse(place: str, problem: str, value: object = _MISSING) -> NoReturn:
    """Raise the error of a place; with `value`, the error shows it."""
    shown = (
        "" if value is _MISSING else ": it is missing" if value is None else f", got {value!r:.{MAX_SHOWN}}"
    )
    raise InvalidArgumentError(f"invalid decoder: {place + ' ' if place else 'it '}{problem}{shown}")


def _is_finite(value: float) -> bool:
    try:
        return isfinite(value)
    except OverflowError:
        return False
