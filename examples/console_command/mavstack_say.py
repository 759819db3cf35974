"""The command `say` for `mav shell`: a status text to all components, as ground stations show it.

Install it with `pip install ./examples/console_command`; `mav shell` then knows `say`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.shell import Command, Session, UsageError
from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


async def say(session: Session, words: list[str]) -> None:
    """Run `say TEXT…` or `say --severity warning TEXT…`."""
    severity = common.MavSeverity.INFO
    if words[:1] == ["--severity"]:
        severity = severity_named(words[1] if len(words) > 1 else "")
        words = words[2:]
    if not words:
        raise UsageError("usage: say [--severity NAME] TEXT…")
    session.connection.send_statustext(" ".join(words), severity)
    session.print(f"said ({severity.name.lower()}): {' '.join(words)}")


def severity_named(name: str) -> common.MavSeverity:
    """Return a severity by its name."""
    try:
        return common.MavSeverity[name.upper()]
    except KeyError:
        names = ", ".join(each.name.lower() for each in common.MavSeverity)
        raise UsageError(f"{name!r} is not a severity; the severities are {names}") from None


async def complete(session: Session, before: Sequence[str], word: str) -> Iterable[str]:
    """Complete the option and the names of severities."""
    if not before:
        return ["--severity"]
    return [each.name.lower() for each in common.MavSeverity] if before == ["--severity"] else []


COMMAND = Command(
    "say",
    "[--severity NAME] TEXT…",
    "send a status text to all components",
    say,
    examples=("say takeoff in one minute", "say --severity warning battery swap"),
    needs_vehicle=False,
    complete=complete,
)
