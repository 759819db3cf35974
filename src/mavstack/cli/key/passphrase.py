"""The passphrase of a key: asked for on a terminal without an echo, or the first line of standard input."""

from __future__ import annotations

import sys
from getpass import getpass

from mavstack.cli.common.errors import UsageError


def read_passphrase() -> str:
    """Return the passphrase that the user gives, twice on a terminal.

    Raises:
        UsageError: It is empty, or the two differ.
    """
    if sys.stdin is not None and sys.stdin.isatty():
        passphrase = getpass("passphrase: ")
        if passphrase and getpass("once more: ") != passphrase:
            raise UsageError("the two passphrases differ")
    else:
        passphrase = "" if sys.stdin is None else sys.stdin.readline().rstrip("\r\n")
    if not passphrase:
        raise UsageError("the passphrase is empty")
    return passphrase
