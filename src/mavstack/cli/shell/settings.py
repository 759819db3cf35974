"""The settings of the shell: `set`, `set NAME`, `set NAME VALUE`."""

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

    #: True if commands that fly wait until the vehicle has finished.
    wait: bool = True
    #: Timeout of commands that fly, in seconds; 0: no timeout.
    timeout: float = 0.0
    #: Status texts of lower severity are not shown.
    severity: common.MavSeverity = common.MavSeverity.DEBUG
    #: Rate that `watch` requests for messages, in hertz; 0 leaves the rate of the vehicle.
    rate: float = 0.0

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Return the names of the settings."""
        return tuple(field.name for field in fields(cls))

    def text(self, name: str) -> str:
        """Return the value of a setting as text; raise `UsageError` if there is no such setting."""
        if name not in self.names():
            raise UsageError(f"there is no setting {name!r}; settings: {', '.join(self.names())}")
        value = getattr(self, name)
        if isinstance(value, bool):
            return "on" if value else "off"
        return value.name.lower() if isinstance(value, common.MavSeverity) else f"{value:g}"

    def change(self, name: str, text: str) -> None:
        """Change a setting; raise `UsageError` for an unknown name or a wrong value."""
        self.text(name)
        current = getattr(self, name)
        if isinstance(current, bool):
            setattr(self, name, _boolean(name, text))
        elif isinstance(current, common.MavSeverity):
            setattr(self, name, _severity(text))
        else:
            setattr(self, name, _number(name, text))


def _boolean(name: str, text: str) -> bool:
    if text.lower() not in _YES | _NO:
        raise UsageError(f"{name} is on or off, not {text!r}")
    return text.lower() in _YES


def _severity(text: str) -> common.MavSeverity:
    try:
        return common.MavSeverity[text.upper()]
    except KeyError:
        names = ", ".join(each.name.lower() for each in common.MavSeverity)
        raise UsageError(f"{text!r} is not a severity; the severities are {names}") from None


def _number(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value < float("inf"):
        raise UsageError(f"{name} must be a number of 0 or more, not {text!r}")
    return value
