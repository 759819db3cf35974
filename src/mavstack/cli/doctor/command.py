"""`mav doctor`: what is installed and working, and what to do about the rest."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

EXAMPLES: Final = """\
examples:
  mav doctor           versions, extras, a test of the core, serial ports, UDP on this machine
  mav doctor --json    the same for programs

It fails only if something fails that must work everywhere; a missing extra is told, with the line that
installs it.
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--json", action="store_true", help="one JSON object for programs")


def run(arguments: Namespace) -> int:
    """Examine everything."""
    from mavstack.cli.doctor.checks import Status, examine
    from mavstack.cli.common.output import table_lines
    from mavstack.errors import MavstackError

    findings = examine()
    failed = [finding for finding in findings if finding.status is Status.FAILED]
    if arguments.json:
        checks = [
            {"name": item.name, "status": item.status.value, "detail": item.detail, "remedy": item.remedy}
            for item in findings
        ]
        print(json.dumps({"ok": not failed, "checks": checks}))
    else:
        rows = [
            (item.name, item.status.value, item.detail + (f": {item.remedy}" if item.remedy else ""))
            for item in findings
        ]
        print("\n".join(table_lines(("CHECK", "STATUS", "DETAIL"), rows, {"CHECK", "STATUS", "DETAIL"})))
    if failed:
        raise CommandError(f"{', '.join(item.name for item in failed)} should work, but does not")
    return 0
