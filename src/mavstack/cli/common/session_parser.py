"""The argument parser of commands that run inside `mav shell`, on the session's vehicle."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import NoReturn

from mavstack.cli.common.errors import UsageError


class SessionParser(ArgumentParser):
    """Parses the words of a command for the vehicle of a session.

    It offers no connection and no log options. The default `session_work` of the parsed arguments is a
    function that takes the work of the command. A wrong argument raises `UsageError` and ends only the
    command.
    """

    def error(self, message: str) -> NoReturn:
        """Raise the problem that argparse found."""
        raise UsageError(message)
