"""Settings by their CLI names: which field of which message has the value, and what values are allowed.

The CLI shows the integers of the firmware. A field in a usual unit is therefore converted by the scale that
its message has for it.
"""

from __future__ import annotations

import dataclasses
import re
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from mavstack.msp.messages.codecs import Number
from mavstack.msp.messages.fields import Record, layout_of
from mavstack.msp.messages.identification import Name
from mavstack.msp.messages.layout import TableMessage
from mavstack.msp.messages.registry import all_messages

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.msp.messages.base import MspMessage
    from mavstack.sim.msp.settings import SettingStore

_TEXT = "-"
_NO_MESSAGE = "[-]"


@dataclass(frozen=True, slots=True)
class CliSetting:
    """One setting.

    Attributes:
        name: Its name in the CLI.
        kind: The message that has it; None for one that has no message.
        path: Names of fields and indices of items that lead to the value in the message.
        minimum: Smallest value; of a text its length.
        maximum: Largest value; of a text its length.
        words: The names of the values 0, 1, …; empty for a number.
        is_text: The value is a text.
        default: The default, if no message has the setting.
    """

    name: str
    kind: type[MspMessage] | None = None
    path: tuple[str | int, ...] = ()
    minimum: int = 0
    maximum: int = 0xFF
    words: tuple[str, ...] = ()
    is_text: bool = False
    default: int = 0

    @property
    def limits(self) -> str:
        """The allowed values, as the CLI shows them."""
        if self.words:
            return f"Allowed values: {', '.join(word for word in self.words if word)}"
        if self.is_text:
            return f"String length: {self.minimum} - {self.maximum}"
        return f"Allowed range: {self.minimum} - {self.maximum}"

    def shown(self, store: SettingStore, *, default: bool = False) -> str:
        """Return the value as the CLI shows it."""
        value = self.value(store, default=default)
        if self.is_text:
            return str(value) or _TEXT
        if self.words:
            return self.words[value] if 0 <= value < len(self.words) else str(value)
        return str(value)

    def value(self, store: SettingStore, *, default: bool = False) -> Any:  # noqa: ANN401 - int or str
        """Return the value, or its default: an integer of the firmware, or a text."""
        if self.kind is None:
            return self.default if default else store.named[self.name]
        message = store.default(self.kind) if default else store.get(self.kind)
        return _raw(message, self.path)

    def parse(self, text: str) -> int | str | None:
        """Return the value of a text; None if it is not allowed."""
        if self.is_text:
            value = "" if text == _TEXT else text
            return value if len(value) <= self.maximum else None
        if self.words:
            found = [index for index, word in enumerate(self.words) if word.lower() == text.lower() and word]
            return found[0] if found else None
        try:
            number = int(text)
        except ValueError:
            return None
        return number if self.minimum <= number <= self.maximum else None

    def store(self, store: SettingStore, value: int | str) -> None:
        """Change the setting."""
        if self.kind is None:
            store.named[self.name] = int(value)
        else:
            store.put(_changed(store.get(self.kind), self.path, value))


class SettingTable:
    """The settings of a firmware by their CLI names, in the order of its dump."""

    def __init__(self, settings: Iterable[CliSetting]) -> None:
        self._settings = {each.name: each for each in settings}

    def __iter__(self) -> Iterator[CliSetting]:
        return iter(self._settings.values())

    def __len__(self) -> int:
        return len(self._settings)

    @property
    def without_message(self) -> dict[str, int]:
        """The defaults of the settings that are in no message, by their names."""
        return {each.name: each.default for each in self if each.kind is None}

    def get(self, name: str) -> CliSetting | None:
        """Return a setting by its name, upper or lower case; None if there is none."""
        return self._settings.get(name.lower())

    def containing(self, text: str) -> list[CliSetting]:
        """Return the settings whose names contain a text."""
        return [each for each in self if text.lower() in each.name]


def read_settings(name: str) -> SettingTable:
    """Return the settings of a file in this folder, whose head describes its lines."""
    messages: dict[str, type[MspMessage]] = {kind.__name__: kind for kind in all_messages()}
    messages[Name.__name__] = Name
    section: type[MspMessage] | None = None
    settings = []
    for line in (files(__package__) / name).read_text("ascii").splitlines():
        if line.startswith("["):
            section = None if line == _NO_MESSAGE else messages[line.strip("[]")]
        elif line and not line.startswith("#"):
            settings.append(_setting(section, *line.split(" | ")))
    return SettingTable(settings)


def _setting(kind: type[MspMessage] | None, name: str, place: str, values: str) -> CliSetting:
    """Return the setting of a line."""
    if " / " in values:
        setting = CliSetting(name, kind, maximum=0, words=tuple(values.split(" / ")))
    else:
        low, high = map(int, values.removeprefix("text ").split(".."))
        setting = CliSetting(name, kind, minimum=low, maximum=high, is_text=values.startswith("text "))
    if kind is None:
        return dataclasses.replace(setting, default=int(place))
    steps = re.findall(r"\w+", place)
    return dataclasses.replace(setting, path=tuple(int(step) if step.isdigit() else step for step in steps))


def _raw(owner: Any, path: tuple[str | int, ...]) -> Any:  # noqa: ANN401 - message, record or list
    """Return the value at a path, as the integer in the payload."""
    step, *rest = path
    value = owner[step] if isinstance(step, int) else getattr(owner, step)
    if rest:
        return _raw(value, tuple(rest))
    codec = _codec(owner, step)
    if codec is None or not isinstance(value, (int, float)):
        return value
    return round((value * codec.per_unit - codec.offset) / codec.step)


def _changed(owner: Any, path: tuple[str | int, ...], raw: int | str) -> Any:  # noqa: ANN401 - as _raw
    """Return a message, record or list with another value at a path."""
    step, *rest = path
    if isinstance(step, int):
        value = _changed(owner[step], tuple(rest), raw) if rest else raw
        return (*owner[:step], value, *owner[step + 1 :])
    if rest:
        return dataclasses.replace(owner, **{step: _changed(getattr(owner, step), tuple(rest), raw)})
    codec = _codec(owner, step)
    if codec is None or isinstance(raw, str):
        return dataclasses.replace(owner, **{step: raw})
    if codec.kind is not None:
        return dataclasses.replace(owner, **{step: codec.kind(raw)})
    stepped = codec.offset + raw * codec.step
    return dataclasses.replace(owner, **{step: stepped if codec.per_unit == 1 else stepped / codec.per_unit})


def _codec(owner: object, step: str | int) -> Number | None:
    """Return how a number stands in its payload; None for what is no number."""
    if isinstance(step, int) or not isinstance(owner, (TableMessage, Record)):
        return None
    layout: Any = type(owner)
    facts = layout_of(layout).get(step)
    return facts.codec if facts is not None and isinstance(facts.codec, Number) else None
