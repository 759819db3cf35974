"""`mav key ticket`: a ticket for one connection to a WebSocket gate."""

from __future__ import annotations

from secrets import token_bytes
from time import time
from typing import TYPE_CHECKING

from mavstack.cli.common.output import echo, echo_json
from mavstack.security.api_keys import read_api_key
from mavstack.security.tickets import LIFETIME, MAVLINK_SCOPE, MAX_LIFETIME, make_ticket

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.cli.common.actions import Actions


def add_action(actions: Actions) -> None:
    """Declare `mav key ticket`."""
    action = actions.add("ticket", "make a ticket for one connection to a WebSocket gate", run)
    action.add_argument(
        "name", metavar="FILE|NAME", help="the key of the gate: a file with its text, or the name of a key"
    )
    action.add_argument("--scope", default=MAVLINK_SCOPE, help=f"what it allows (default: {MAVLINK_SCOPE})")
    action.add_argument(
        "--lifetime",
        type=int,
        default=LIFETIME,
        metavar="SECONDS",
        help=f"seconds until it expires, 1 to {MAX_LIFETIME} (default: {LIFETIME})",
    )
    action.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: Namespace) -> int:
    """Run `mav key ticket`."""
    now = time()
    ticket = make_ticket(
        read_api_key(arguments.name),
        now=now,
        nonce=token_bytes(16),
        scope=arguments.scope,
        lifetime=arguments.lifetime,
    )
    if arguments.json:
        expires = int(now) + arguments.lifetime
        echo_json({"ticket": ticket, "scope": arguments.scope, "expires": expires})
    else:
        echo(ticket)
    return 0
