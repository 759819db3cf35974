"""Messages, commands and components of the configuration: by name or by number.

Each function raises `ValueError` with a suggestion.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import Dialect

if TYPE_CHECKING:
    from collections.abc import Mapping

#: Ids of COMMAND_INT and COMMAND_LONG.
COMMAND_MESSAGES: Final = frozenset({75, 76})
MAX_MESSAGE: Final = 0xFFFFFF
MAX_COMMAND: Final = 0xFFFF
_MAX_ID: Final = 255


class Names:
    """The names of one dialect.

    Args:
        dialect: Name of an official dialect, or path of a definition file.

    Raises:
        DialectError: There is no such dialect.
    """

    def __init__(self, dialect: str) -> None:
        self.dialect = Dialect.from_xml(dialect) if dialect.endswith(".xml") else Dialect.load(dialect)
        self._messages: Mapping[str, int] | None = None

    def message(self, value: object) -> int:
        """Return the id of a message."""
        if self._messages is None:
            self._messages = {
                name: number for each in self.dialect.with_includes for name, number in each.table.ids.items()
            }
        return _number(value, self._messages, "message", MAX_MESSAGE)

    def command(self, value: object) -> int:
        """Return the number of a MAV_CMD; the name may lack `MAV_CMD_`.

        A dialect without both messages of commands is refused: a rule for commands would not see them.
        """
        if not all(message in self.dialect for message in COMMAND_MESSAGES):
            raise ValueError(
                "the dialect of the router has no COMMAND_INT or no COMMAND_LONG: set another dialect"
            )
        return _number(value, self._entries("MAV_CMD"), "command", MAX_COMMAND)

    def component(self, value: object) -> int:
        """Return a component id; the name may lack `MAV_COMP_ID_`."""
        return _number(value, self._entries("MAV_COMPONENT"), "component", _MAX_ID)

    def message_name(self, number: int) -> str | int:
        """Return the name of a message; its id if the dialect has none."""
        return self.dialect.name_of(number) if number in self.dialect else number

    def _entries(self, enum: str) -> Mapping[str, int]:
        prefix = {"MAV_CMD": "MAV_CMD_", "MAV_COMPONENT": "MAV_COMP_ID_"}[enum]
        return {name.removeprefix(prefix): value for name, value in self.dialect.enum_values(enum).items()}


def system(value: object) -> int:
    """Return a system id from 1 to 255."""
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= _MAX_ID:
        raise ValueError(f"{value!r} is not a system id from 1 to {_MAX_ID}")
    return value


def _number(value: object, names: Mapping[str, int], kind: str, maximum: int) -> int:
    if isinstance(value, int) and not isinstance(value, bool):
        if not 0 <= value <= maximum:
            raise ValueError(f"{value} is not a {kind} number from 0 to {maximum}")
        return value
    if not isinstance(value, str):
        raise ValueError(f"{value!r} is not the name or number of a {kind}")
    name = value.strip().upper()
    for prefix in ("", "MAV_CMD_", "MAV_COMP_ID_"):
        if name.removeprefix(prefix) in names:
            return names[name.removeprefix(prefix)]
    from difflib import get_close_matches

    near = get_close_matches(name, names, n=1)
    hint = f"; did you mean {near[0]}?" if near else ": use its name or its number"
    raise ValueError(f"there is no {kind} {value!r}{hint}")
