"""`mav doctor`: check the installation, and show how to mend what fails or is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

EXAMPLES: Final = """\
examples:
  mav doctor           # versions, extras, the core, serial ports, UDP on this machine
  mav doctor --json    # the same as JSON

The command fails only if a check fails that must pass everywhere. A missing extra is shown with the command
that installs it.
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(arguments: Namespace) -> int:
    """Run all checks."""
    from mavstack.cli.common.errors import CommandError
    from mavstack.cli.common.output import echo, echo_json, table_lines
    from mavstack.cli.doctor.checks import Status, run_checks

    findings = run_checks()
    failed = [finding for finding in findings if finding.status is Status.FAILED]
    if arguments.json:
        checks = [
            {"name": item.name, "status": item.status.value, "detail": item.detail, "remedy": item.remedy}
            for item in findings
        ]
        echo_json({"ok": not failed, "checks": checks})
    else:
        rows = [
            (item.name, item.status.value, item.detail + (f": {item.remedy}" if item.remedy else ""))
            for item in findings
        ]
        echo(*table_lines(("CHECK", "STATUS", "DETAIL"), rows, {"CHECK", "STATUS", "DETAIL"}))
    if failed:
        raise CommandError(f"checks failed: {', '.join(item.name for item in failed)}")
    return 0
