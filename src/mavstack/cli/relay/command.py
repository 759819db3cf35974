"""`mav relay`: a meeting place for vehicles and ground stations that both only dial out."""

from __future__ import annotations

import asyncio
from pathlib import Path
from secrets import token_hex
from time import time
from typing import TYPE_CHECKING, Final
from urllib.parse import parse_qsl, urlsplit

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.errors import InvalidArgumentError
from mavstack.http.web_origin import is_loopback
from mavstack.links import LinkURL
from mavstack.security.api_keys import read_api_key
from mavstack.security.room_tickets import MAX_LIFETIME, Seat, make_room_ticket

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.relay.server import RelayServer

EXAMPLES: Final = """\
examples:
  mav key new relay                                                  # the key of the relay's tickets
  mav relay serve --tickets relay --port 7070                        # this machine alone
  mav relay serve --tickets relay --host 0.0.0.0 --certificate server.pem
  mav relay invite boat wss://relay.example:7070 --tickets relay     # a URL for each side
  mav relay serve --tickets relay --revoked revoked.txt
  mav relay revoke 'relay://relay.example:7070?ticket=TICKET' --list revoked.txt   # end one URL
  mav relay invite boat ws://127.0.0.1:7070 --tickets relay --days 7 --json

The vehicle's side opens the first URL (mav route, mav sim --out …), the ground the second (mav watch …,
mav web …). Packets are sealed between both: the relay cannot read or change them.
"""
MAX_PORT: Final = 65535
_DAY: Final = 86_400
_DEFAULT_DAYS: Final = 30
_PORTS: Final = {"ws": 80, "wss": 443}


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "relay", EXAMPLES)
    _add_serve(actions)
    _add_invite(actions)
    action = actions.add("revoke", "end one URL or ticket before it expires", revoke)
    action.add_argument("invitation", metavar="URL", help="the URL that invite printed, or its ticket")
    action.add_argument(
        "--list", dest="path", type=Path, required=True, metavar="FILE",
        help="the file that the relay reads by --revoked; the ticket is added",
    )  # fmt: skip


def _add_serve(actions: Actions) -> None:
    from mavstack.relay.rooms import Limits

    limits = Limits()
    add = actions.add("serve", "run a relay until Ctrl-C", serve).add_argument
    add("--tickets", required=True, metavar="KEY", help="the key of the tickets: a file or a key's name")
    add("--host", default="127.0.0.1", metavar="ADDRESS", help="address to listen on (default: 127.0.0.1)")
    add("--port", type=int, default=7070, metavar="N", help="port; 0: a free one (default: 7070)")
    add("--revoked", type=Path, metavar="FILE", help="tickets that end early; see mav relay revoke")
    add("--certificate", metavar="FILE", help="serve TLS with this certificate (PEM)")
    add("--certificate-key", metavar="FILE", help="its private key, if it is in another file")
    add(
        "--max-members",
        type=int,
        default=limits.members,
        metavar="N",
        help=f"connections at the same time (default: {limits.members})",
    )
    add(
        "--max-guests",
        type=int,
        default=limits.guests,
        metavar="N",
        help=f"guests of one room (default: {limits.guests})",
    )
    add(
        "--pace", type=int, default=limits.pace >> 10, metavar="KB",
        help=f"kilobytes per second that one connection may send (default: {limits.pace >> 10})",
    )  # fmt: skip
    add("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")
    add("--json", action="store_true", help="print the address, and at the end the counts, as JSON objects")


def _add_invite(actions: Actions) -> None:
    add = actions.add(
        "invite", "print the URLs with which a vehicle and a ground station meet", invite
    ).add_argument
    add("room", metavar="ROOM", help="name of the room: lower-case letters, digits and hyphens")
    add("relay", metavar="URL", help="the relay, such as wss://relay.example:7070")
    add("--tickets", required=True, metavar="KEY", help="the key of the relay: a file or a key's name")
    add(
        "--days", type=float, default=_DEFAULT_DAYS, metavar="N",
        help=f"days until the URLs expire (default: {_DEFAULT_DAYS})",
    )  # fmt: skip
    add("--json", action="store_true", help="print JSON")


def serve(arguments: Namespace) -> int:
    """Run `mav relay serve`."""
    from mavstack.relay.rooms import Limits
    from mavstack.relay.server import RelayServer

    if not 0 <= arguments.port <= MAX_PORT:
        raise UsageError(f"--port must be from 0 to {MAX_PORT}, got {arguments.port}")
    if min(arguments.max_members, arguments.max_guests, arguments.pace) < 1:
        raise UsageError("--max-members, --max-guests and --pace must be at least 1")
    if arguments.certificate_key and not arguments.certificate:
        raise UsageError("--certificate-key needs --certificate")
    limits = Limits(arguments.max_members, arguments.max_guests, pace=arguments.pace << 10)
    server = RelayServer(
        read_api_key(arguments.tickets),
        limits,
        certificate=arguments.certificate,
        certificate_key=arguments.certificate_key,
        revoked=arguments.revoked,
    )
    return run_until_signal(_serve(arguments, server))


async def _serve(arguments: Namespace, server: RelayServer) -> int:
    async with server.serving(arguments.host, arguments.port) as port:
        scheme = "wss" if arguments.certificate else "ws"
        host = f"[{arguments.host}]" if ":" in arguments.host else arguments.host
        url = f"{scheme}://{host}:{port}"
        if arguments.json:
            echo_json({"url": url, "port": port})
        else:
            echo(f"relay on {url}; Ctrl-C to end")
        if not (arguments.certificate or is_loopback(arguments.host)):
            echo("mav relay: tickets travel in clear text over the network: give --certificate", error=True)
        try:
            await asyncio.wait_for(asyncio.Event().wait(), arguments.duration)
        except TimeoutError:
            return 0
        finally:
            if arguments.json:
                echo_json({"counts": dict(server.rooms.counts)})
    return 0


def revoke(arguments: Namespace) -> int:
    """Run `mav relay revoke`."""
    from mavstack.relay.revocations import revoke as revoke_ticket

    query = dict(parse_qsl(arguments.invitation.partition("?")[2]))
    try:
        is_new = revoke_ticket(query.get("ticket", arguments.invitation), arguments.path)
    except InvalidArgumentError as error:
        raise UsageError(str(error)) from None
    echo("revoked" if is_new else "it was revoked before")
    return 0


def invite(arguments: Namespace) -> int:
    """Run `mav relay invite`."""
    lifetime = arguments.days * _DAY
    if not 0 < lifetime <= MAX_LIFETIME:
        raise UsageError(
            f"--days must be more than 0 and at most {MAX_LIFETIME // _DAY}, got {arguments.days:g}"
        )
    api_key, expires, secret = read_api_key(arguments.tickets), time() + lifetime, token_hex(32)
    try:
        tickets = {seat: make_room_ticket(api_key, arguments.room, seat, expires=expires) for seat in Seat}
    except InvalidArgumentError as error:
        raise UsageError(str(error)) from None
    host = _url("relayin", arguments.relay, tickets[Seat.HOST], secret)
    guest = _url("relay", arguments.relay, tickets[Seat.GUEST], secret)
    if arguments.json:
        echo_json({"room": arguments.room, "host": host, "guest": guest, "expires": int(expires)})
        return 0
    echo(f"room {arguments.room}, until {arguments.days:g} days from now", error=True)
    echo("for the vehicle:", f"  {host}", "for ground stations:", f"  {guest}")
    echo("a URL opens the room for everybody: keep it secret, like a password", error=True)
    return 0


def _url(scheme: str, relay: str, ticket: str, secret: str) -> str:
    try:
        parts = urlsplit(relay if "://" in relay else f"wss://{relay}")
        port = parts.port
    except ValueError:
        parts, port = urlsplit(""), None
    if parts.scheme not in _PORTS or not parts.hostname:
        raise UsageError(f"{relay} is not the URL of a relay, such as wss://relay.example:7070")
    options = {"ticket": ticket, "secret": secret} | ({"tls": "no"} if parts.scheme == "ws" else {})
    return str(LinkURL(scheme, parts.hostname, port or _PORTS[parts.scheme], parts.path, options))
