"""The start of `mav`: Ctrl-C during its imports ends it without a traceback."""

from __future__ import annotations

from mavstack.cli.common.interrupted_imports import ended_by_sigint


def main() -> int:
    """Run `mav` with the words of the process.

    Returns:
        The exit code.
    """
    with ended_by_sigint():
        from mavstack.cli.main import main as run
    return run()
