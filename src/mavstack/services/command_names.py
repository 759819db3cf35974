"""Names of commands for errors and displays: official ones, and those of a user's own dialect."""

from __future__ import annotations

from contextlib import suppress

from mavstack.dialects import common
from mavstack.dialects.enums import MavEnum

_PREFIX = "MAV_CMD_"


def command_name(command: int) -> str:
    """Return a command's official name without MAV_CMD_, or its number if it is unknown.

    Args:
        command: The MAV_CMD; a member of any dialect's enum has the name of that dialect.
    """
    if isinstance(command, MavEnum):
        with suppress(KeyError):
            return command.official_name.removeprefix(_PREFIX)
    try:
        return common.MavCmd(command).official_name.removeprefix(_PREFIX)
    except ValueError:
        return f"MAV_CMD {int(command)}"


def command_of_dialect(command: int, dialect: object) -> int:
    """Return a command as a member of a dialect's MAV_CMD, so that errors name it.

    Args:
        command: The MAV_CMD.
        dialect: A `Dialect` or a dialect module.

    Returns:
        The member; the command unchanged if `common` knows it or the dialect does not.
    """
    if isinstance(command, MavEnum):
        return command
    with suppress(ValueError):
        common.MavCmd(command)
        return command
    enums = getattr(getattr(dialect, "dialect", None), "enums", {})
    try:
        member: int = enums["MAV_CMD"](command)
    except (KeyError, ValueError):
        return command
    return member
