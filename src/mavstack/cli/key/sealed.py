"""The keys of sealed links: `mav key new --sealed` and `mav key public`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import echo, echo_json
from mavstack.security.key_store import key_path

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.cli.common.actions import Actions


def add_option(parser: ArgumentParser) -> None:
    """Declare `--sealed`."""
    parser.add_argument(
        "--sealed",
        action="store_true",
        help="make a key pair for sealed links (sealed+udpin://…?private_key=NAME) instead of a signing key",
    )


def add_action(actions: Actions) -> None:
    """Declare `mav key public`."""
    action = actions.add("public", "print the public key of a key for sealed links", show_public)
    action.add_argument("name", metavar="FILE|NAME", help="the key: its name, or the path of its file")
    action.add_argument("--json", action="store_true", help="print JSON")


def new(arguments: Namespace) -> int:
    """Run `mav key new --sealed`."""
    from mavstack.security.sealed.keys import new_private_key, public_key, read_private_key

    if arguments.passphrase or arguments.keyring:
        raise UsageError("--sealed makes a random key in a file: leave out --passphrase and --keyring")
    key_path(arguments.name)
    path = new_private_key(arguments.name)
    public = public_key(read_private_key(str(path))).hex()
    if arguments.json:
        echo_json({"name": arguments.name, "public": public, "path": str(path)})
    else:
        echo(f"{path} made; links take it with private_key={arguments.name}; its public key is", public)
    return 0


def show_public(arguments: Namespace) -> int:
    """Run `mav key public`."""
    from mavstack.security.sealed.keys import public_key, read_private_key

    public = public_key(read_private_key(arguments.name)).hex()
    if arguments.json:
        echo_json({"public": public})
    else:
        echo(public)
    return 0
