"""Typed reading of the options of a link URL.

Each backend reads its options while it is constructed. Options that are still unread after that are errors of
the user (such as `?buad=57600`), and the error text names the known options.
"""

from __future__ import annotations

import re
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NoReturn, TypeVar

from mavstack.errors import LinkURLError
from mavstack.links.url import redact_options

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from mavstack.links.url import LinkURL

Value = TypeVar("Value")

_TIMES: Final[Mapping[str, float]] = MappingProxyType(
    {"us": 1e-6, "ms": 1e-3, "": 1.0, "s": 1.0, "min": 60.0}
)
_SIZES: Final[Mapping[str, float]] = MappingProxyType({"": 1, "k": 1 << 10, "m": 1 << 20, "g": 1 << 30})
_FRACTIONS: Final[Mapping[str, float]] = MappingProxyType({"": 1.0, "%": 0.01})
_FLAGS: Final[Mapping[str, bool]] = MappingProxyType(
    {"yes": True, "true": True, "on": True, "1": True, "no": False, "false": False, "off": False, "0": False}
)
_QUANTITY = re.compile(r"(\d+(?:\.\d*)?|\.\d+)(?:e([+-]?\d{1,2}))?\s*([a-z%]*)", re.IGNORECASE)


class Options:
    """The options of one link URL; every method raises `LinkURLError` if the value is malformed."""

    def __init__(self, url: LinkURL) -> None:
        self._url = url
        self._known: dict[str, None] = {}

    def has(self, name: str) -> bool:
        """Return whether the option is given."""
        self._known[name] = None
        return name in self._url.options

    def of(self, url: LinkURL) -> Options:
        """Return the options of a link below this one; those that it reads count as read here too."""
        options = Options(url)
        options._known = self._known
        return options

    def text(self, name: str, default: str = "") -> str:
        """Return the option as text."""
        return self._url.options[name] if self.has(name) else default

    def choice(self, name: str, choices: Sequence[str]) -> str:
        """Return one of several words; the first one is the default."""
        value = self.text(name, choices[0])
        if value not in choices:
            self._refuse(name, "one of " + ", ".join(choices))
        return value

    def flag(self, name: str, *, default: bool) -> bool:
        """Return true for yes and false for no."""
        value = self.text(name, "yes" if default else "no").lower()
        if value not in _FLAGS:
            self._refuse(name, "yes or no")
        return _FLAGS[value]

    def integer(self, name: str, default: int, minimum: int = 1) -> int:
        """Return an integer of at least `minimum`."""
        value = self.text(name, str(default))
        if not re.fullmatch(r"[0-9]{1,18}", value) or int(value) < minimum:
            self._refuse(name, f"an integer of at least {minimum}")
        return int(value)

    def seconds(self, name: str, default: float) -> float:
        """Return a time in seconds, given as 200ms or 1.5s."""
        return self._quantity(name, default, _TIMES, "a time such as 200ms or 1.5s")

    def size(self, name: str, default: int) -> int:
        """Return a number of bytes, given as 64k or 4M."""
        return int(self._quantity(name, default, _SIZES, "a number of bytes such as 64k or 4M"))

    def fraction(self, name: str, default: float) -> float:
        """Return a probability, given as 0.1 or 10%."""
        value = self._quantity(name, default, _FRACTIONS, "between 0 and 1, such as 0.1 or 10%")
        if value > 1:
            self._refuse(name, "between 0 and 1, such as 0.1 or 10%")
        return value

    def parsed(self, name: str, parse: Callable[[str], Value], expected: str) -> Value | None:
        """Return the option as `parse` reads it, None if it is not given; `expected` describes valid values.

        `parse` raises ValueError or KeyError for any other text.
        """
        text = self.text(name)
        if not self.has(name):
            return None
        try:
            return parse(text)
        except (KeyError, ValueError):
            self._refuse(name, expected)

    def prefixed(self, prefix: str) -> dict[str, str]:
        """Return the options whose names begin with a prefix, by the rest of their names."""
        found = {name: text for name, text in self._url.options.items() if name.startswith(prefix)}
        self._known.update(dict.fromkeys([f"{prefix}NAME", *found]))
        return {name.removeprefix(prefix): text for name, text in found.items()}

    def refuse_unknown(self) -> None:
        """Raise `LinkURLError` if an option was not read by any of the other methods."""
        for name in self._url.options:
            if name not in self._known:
                from difflib import get_close_matches

                near = get_close_matches(name, self._known, n=1)
                hint = (
                    f"did you mean {near[0]}?" if near else "known options: " + ", ".join(sorted(self._known))
                )
                raise LinkURLError(f"{self._url.redacted}: {self._url.scheme} has no option {name!r}; {hint}")

    def _quantity(self, name: str, default: float, units: Mapping[str, float], expected: str) -> float:
        if not self.has(name):
            return default
        match = _QUANTITY.fullmatch(self._url.options[name].strip())
        if match is None or match[3].lower() not in units:
            self._refuse(name, expected)
        value = float(f"{match[1]}e{match[2] or 0}") * units[match[3].lower()]
        if not isfinite(value):
            self._refuse(name, expected)
        return value

    def _refuse(self, name: str, expected: str) -> NoReturn:
        text = redact_options(f"?{name}={self._url.options[name]}")[1:]
        raise LinkURLError(f"{self._url.redacted}: the option {text} must be {expected}")
