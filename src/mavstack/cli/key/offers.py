"""`mav key identity`, `offer` and `accept`: a key sent to another station, encrypted and signed."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.bounded_file import read_file_bounded
from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.output import echo, echo_json
from mavstack.security.key_store import find_key, find_stored, store_key, uses_keyring

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.cli.common.actions import Actions


def add_actions(actions: Actions) -> None:
    """Declare the actions."""
    action = actions.add("identity", "make an identity, for keys that are sent between stations", make)
    action.add_argument("name", metavar="NAME", help="name of the identity")
    _add_json(action)
    action = actions.add("offer", "encrypt a key for another station, and sign it", offer)
    action.add_argument("name", metavar="FILE|NAME", help="the key: its name, or the path of its file")
    _add_identity(action, "--to", "public identity of the recipient")
    action.add_argument("-o", "--output", required=True, metavar="FILE", help="file to write")
    action = actions.add("accept", "verify and decrypt a key that another station sent", accept)
    action.add_argument("offer", metavar="FILE", help="the file that the station sent")
    action.add_argument("name", metavar="NAME", help="name that the key gets here")
    _add_identity(action, "--from", "public identity of the sender, which you have checked")


def make(arguments: Namespace) -> int:
    """Run `mav key identity`."""
    from mavstack.security.identity_store import load_public, make_identity

    path = make_identity(arguments.name)
    fingerprint = load_public(path).fingerprint
    if arguments.json:
        echo_json({"name": arguments.name, "public": str(path), "fingerprint": fingerprint})
    else:
        echo(f"{path} made; send it to other stations, and compare this fingerprint by voice:", fingerprint)
    return 0


def offer(arguments: Namespace) -> int:
    """Run `mav key offer`."""
    from mavstack.security.identity_store import load_identity, load_public

    key, recipient = find_key(arguments.name), load_public(arguments.other)
    data = load_identity(arguments.identity).offer(key, recipient, time.time())
    try:
        write_file_atomically(arguments.output, data)
    except OSError as error:
        raise CommandError(f"cannot write {arguments.output}: {error.strerror or error}") from None
    facts = {"file": arguments.output, "fingerprint": key.fingerprint, "recipient": recipient.fingerprint}
    _report(arguments, facts, f"{arguments.output} made, for the station {recipient.fingerprint[:16]}…")
    return 0


def accept(arguments: Namespace) -> int:
    """Run `mav key accept`."""
    from mavstack.security.identity_store import MAX_FILE_SIZE, accept_once, load_identity, load_public

    if find_stored(arguments.name) is not None:
        # check this before the offer is accepted: an offer can be accepted only once
        raise CommandError(f"there is a signing key {arguments.name!r} already")
    try:
        data = read_file_bounded(Path(arguments.offer), MAX_FILE_SIZE)
    except OSError as error:
        raise CommandError(f"cannot open {arguments.offer}: {error.strerror or error}") from None
    identity, sender = load_identity(arguments.identity), load_public(arguments.other)
    key = accept_once(identity, data, sender, time.time())
    path = store_key(arguments.name, key, keyring=uses_keyring())
    facts = {"name": arguments.name, "fingerprint": key.fingerprint, "path": str(path)}
    _report(arguments, facts, f"{path} made; commands take it with --key {arguments.name}")
    return 0


def _add_identity(action: ArgumentParser, option: str, description: str) -> None:
    action.add_argument("--identity", required=True, metavar="NAME", help="your own identity")
    action.add_argument(option, dest="other", required=True, metavar="FILE", help=description)
    _add_json(action)


def _add_json(parser: ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON")


def _report(arguments: Namespace, facts: dict[str, object], text: str) -> None:
    if arguments.json:
        echo_json(facts)
    else:
        echo(text)
