"""What can be set in the shell: `set`, `set NAME`, `set NAME VALUE`."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Final

from mavstack.cli.common.errors import UsageError
from mavstack.dialects import common

_YES: Final = frozenset({"1", "on", "yes", "true"})
_NO: Final = frozenset({"0", "off", "no", "false"})


@dataclass
class Settings:
    """The settings of a session."""

    #: Whether commands that fly wait until it is done.
    wait: bool = True
    #: How long they wait at most, in seconds; 0 for as long as the vehicle gets on.
    limit: float = 0.0
    #: The least important texts of vehicles that are shown.
    severity: common.MavSeverity = common.MavSeverity.DEBUG
    #: How often `watch` asks for a message, in hertz; 0 for as often as it comes by itself.
    rate: float = 0.0

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """What can be set."""
        return tuple(field.name for field in fields(cls))

    def text(self, name: str) -> str:
        """A setting as it is typed; raises `UsageError` if there is none."""
        if name not in self.names():
            raise UsageError(f"there is no setting {name!r}; settings: {', '.join(self.names())}")
        value = getattr(self, name)
        if isinstance(value, bool):
            return "on" if value else "off"
        return value.name.lower() if isinstance(value, common.MavSeverity) else f"{value:g}"

    def change(self, name: str, text: str) -> None:
        """Set it from what was typed; raises `UsageError`."""
        self.text(name)
        now = getattr(self, name)
        if isinstance(now, bool):
            setattr(self, name, _switch(name, text))
        elif isinstance(now, common.MavSeverity):
            setattr(self, name, _severity(text))
        else:
            setattr(self, name, _amount(name, text))


def _switch(name: str, text: str) -> bool:
    if text.lower() not in _YES | _NO:
        raise UsageError(f"{name} is on or off, not {text!r}")
    return text.lower() in _YES


def _severity(text: str) -> common.MavSeverity:
    try:
        return common.MavSeverity[text.upper()]
    except KeyError:
        names = ", ".join(each.name.lower() for each in common.MavSeverity)
        raise UsageError(f"{text!r} is no severity; there are {names}") from None


def _amount(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value < float("inf"):
        raise UsageError(f"{name} is a number from 0 on, not {text!r}")
    return value
