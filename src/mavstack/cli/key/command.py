"""`mav key`: the user's signing keys, and the key of a vehicle.

The keys are files in the user's key directory, or are in the keyring of the system (see
`mavstack.security.key_store`); every command that opens
a link takes one by its name with `--key`. A vehicle gets a key by SETUP_SIGNING, which carries it in the
clear. A first key is therefore sent only after the user has confirmed the channel, by a question or by
`--yes`; a later one over the channel on which the vehicle was verified with its present key.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.confirmation import add_yes_option, is_confirmed_while_connected
from mavstack.cli.common.connection import add_heartbeat_timeout, run_on_vehicle
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.link_options import add_link_options
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.selection import add_system_option, of_vehicle
from mavstack.cli.common.text import printable
from mavstack.cli.key import inventory, offers, sealed, ticket
from mavstack.cli.key.passphrase import read_passphrase
from mavstack.cli.key.rotate import rotate
from mavstack.cli.key.vehicle_key import require_ready
from mavstack.errors import RemoteTimeout
from mavstack.security import SigningKey
from mavstack.security.key_store import find_key, key_path, store_key, uses_keyring

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.vehicle import Vehicle

EXAMPLES: Final = """\
examples:
  mav key new fleet                                 # a random key
  mav key new club --passphrase                     # the key that ground stations make of a passphrase
  mav key list
  mav key install fleet /dev/ttyACM0                # a first key, over a cable
  mav key install fleet udpin://127.0.0.1:14550 --yes
  mav key rotate fleet udpin://0.0.0.0:14550 --all  # a new key for every vehicle that uses fleet
  mav key install next udpin://0.0.0.0:14550 --key fleet    # another key, signed with the present one
  mav key off udpin://0.0.0.0:14550 --key next      # turn signing off
  mav key remove club                               # forget it on this machine
  mav key new --sealed boat                         # a key pair for sealed links
  mav key public boat                               # the half of it that the other end needs
  mav key remove boat --kind sealed                 # if a signing key has this name too
  mav key ticket fleet                              # for one connection to wsin://…?ticket_key=fleet
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "key", EXAMPLES)
    action = actions.add("new", "make a key on this machine", new)
    action.add_argument("name", metavar="NAME", help="name of the key: letters, digits, '_', '-' and '.'")
    action.add_argument(
        "--passphrase",
        action="store_true",
        help="make it of a passphrase as ground stations do (SHA-256); it is asked for, or read from stdin",
    )
    action.add_argument(
        "--keyring",
        action="store_true",
        help="store it in the keyring of the system instead of a file (MAVSTACK_KEY_STORE=keyring: always)",
    )
    sealed.add_option(action)
    _add_json(action)
    inventory.add_list(actions)
    action = actions.add("install", "set the signing key of a vehicle", install)
    action.add_argument("name", metavar="FILE|NAME", help="the new key: its name, or the path of its file")
    _add_vehicle(action)
    add_yes_option(action)
    action = actions.add("rotate", "give all vehicles of a key another one, one after the other", rotate)
    action.add_argument("name", metavar="NAME", help="name of the present key, which the new one gets")
    _add_vehicle(action, rotates=True)
    action = actions.add("off", "turn signing off on a vehicle", turn_off)
    _add_vehicle(action)
    inventory.add_remove(actions)
    ticket.add_action(actions)
    sealed.add_action(actions)
    offers.add_actions(actions)


def _add_json(parser: ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON")


def _add_vehicle(parser: ArgumentParser, *, rotates: bool = False) -> None:
    """Declare the link to the vehicle, which is always named: a key goes nowhere by default."""
    # the selection of the vehicle refuses changes during a system id conflict
    parser.set_defaults(changes=True)
    parser.add_argument("url", nargs=1, metavar="URL", help="link to the vehicle")
    parser.add_argument(
        "--action-timeout",
        type=seconds,
        metavar="SECONDS",
        help="time for the whole action (default: as long as the vehicle may still answer)",
    )
    _add_json(parser)
    group = parser.add_argument_group("vehicle")
    add_system_option(group, fleet=rotates, changes=True)
    add_heartbeat_timeout(group)
    add_link_options(parser.add_argument_group("links"), key=not rotates)


def new(arguments: Namespace) -> int:
    """Run `mav key new`."""
    if arguments.sealed:
        return sealed.new(arguments)
    key_path(arguments.name)  # refuse an invalid name before a passphrase is asked for
    key = SigningKey.from_passphrase(read_passphrase()) if arguments.passphrase else SigningKey.generate()
    path = store_key(arguments.name, key, keyring=arguments.keyring or uses_keyring())
    facts = {"name": arguments.name, "fingerprint": key.fingerprint, "path": str(path)}
    _report(arguments, facts, f"{path} made; commands take it with --key {arguments.name}")
    return 0


def install(arguments: Namespace) -> int:
    """Run `mav key install`."""
    key = find_key(arguments.name)

    async def work(vehicle: Vehicle) -> int:
        await require_ready(vehicle, arguments)
        channel = None if arguments.signing_key else _channel_of(vehicle)
        if channel is not None and not await _is_confirmed(vehicle, arguments, channel):
            return 1
        await _setup_signing(vehicle, arguments, key, channel)
        facts = {"system": vehicle.system, "key": arguments.name, "fingerprint": key.fingerprint}
        text = f"signs and verifies with the key {arguments.name}; reach it with --key {arguments.name}"
        _report(arguments, facts, of_vehicle(vehicle, text))
        return 0

    return run_on_vehicle(arguments, work)


def turn_off(arguments: Namespace) -> int:
    """Run `mav key off`."""
    arguments.name = arguments.signing_key
    if arguments.name is None:
        raise UsageError("name the present key with --key: only its holder can turn signing off")

    async def work(vehicle: Vehicle) -> int:
        await require_ready(vehicle, arguments)
        await _setup_signing(vehicle, arguments, None, None)
        _report(arguments, {"system": vehicle.system, "key": None}, of_vehicle(vehicle, "signing turned off"))
        return 0

    return run_on_vehicle(arguments, work)


def _channel_of(vehicle: Vehicle) -> str:
    """Return the name of the channel that leads to the vehicle."""
    channels = vehicle.component.channels
    if len(channels) != 1:
        raise CommandError(of_vehicle(vehicle, "it is heard over several channels; name one link to it"))
    return channels[0]


async def _is_confirmed(vehicle: Vehicle, arguments: Namespace, channel: str) -> bool:
    """Return whether the user agrees to send a key in the clear over a channel."""
    question = (
        f"the key is sent in the clear to vehicle {vehicle.system} over {printable(channel)}: whoever reads "
        "this link learns it. Send it"
    )
    return await is_confirmed_while_connected(arguments, question, "send a first key in the clear")


async def _setup_signing(
    vehicle: Vehicle, arguments: Namespace, key: SigningKey | None, channel: str | None
) -> None:
    unknown = "it may have taken it: try with" if key is not None else "signing may be off: try without"
    unknown = f"{unknown} --key {arguments.name}"
    try:
        await vehicle.component.setup_signing(key, channel=channel, timeout=arguments.action_timeout)
    except RemoteTimeout as error:
        raise CommandError(f"{error}; {unknown}") from error
    except asyncio.CancelledError:
        echo(f"interrupted: vehicle {vehicle.system}: {unknown}", error=True)
        raise


def _report(arguments: Namespace, for_programs: dict[str, object], text: str) -> None:
    if arguments.json:
        echo_json(for_programs)
    else:
        echo(text)
