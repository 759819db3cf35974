"""`mav key list` and `mav key remove`: signing keys and the keys of sealed links on this machine."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

from mavstack.cli.common.confirmation import add_yes_option, is_confirmed
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.errors import MissingExtraError, SigningError
from mavstack.security.key_store import (
    delete_key,
    delete_sealed_key,
    find_stored,
    key_names,
    load_stored_key,
    require_sealed,
    require_stored,
    sealed_key_names,
    sealed_key_path,
)

if TYPE_CHECKING:
    from argparse import Namespace
    from pathlib import Path

    from mavstack.cli.common.actions import Actions


class Kind(StrEnum):
    """The use of a key."""

    SIGNING = "signing"
    SEALED = "sealed"


class Row(NamedTuple):
    """A line of the list; a key has a fingerprint or a problem."""

    name: str
    kind: Kind
    fingerprint: str
    problem: str


def add_list(actions: Actions) -> None:
    """Declare `mav key list`."""
    action = actions.add("list", "list the keys on this machine: signing keys, keys of sealed links", show)
    action.add_argument("--json", action="store_true", help="print JSON")


def add_remove(actions: Actions) -> None:
    """Declare `mav key remove`."""
    action = actions.add("remove", "remove a key from this machine; vehicles keep it", remove)
    action.add_argument("name", metavar="NAME", help="name of the key")
    action.add_argument(
        "--kind",
        choices=[kind.value for kind in Kind],
        help="the kind of the key, if a signing and a sealed one have this name",
    )
    add_yes_option(action)
    action.add_argument("--json", action="store_true", help="print JSON")


def show(arguments: Namespace) -> int:
    """Run `mav key list`."""
    rows = [*map(_signing_row, key_names()), *map(_sealed_row, sealed_key_names())]
    rows.sort()
    if arguments.json:
        echo_json([_for_programs(row) for row in rows])
    elif rows:
        echo(*align_columns([("NAME", "KIND", "FINGERPRINT", ""), *rows]))
    else:
        echo("there is no key; mav key new NAME makes one", error=True)
    return 0


def remove(arguments: Namespace) -> int:
    """Run `mav key remove`."""
    kind, path = _find(arguments.name, arguments.kind)
    peer = "A vehicle" if kind is Kind.SIGNING else "The other end of a sealed link"
    question = f"remove {path}? {peer} that uses this key cannot be reached without it. Remove it"
    if not is_confirmed(arguments, question, "remove a key", refused="nothing was removed"):
        return 1
    (delete_key if kind is Kind.SIGNING else delete_sealed_key)(arguments.name)
    if arguments.json:
        echo_json({"removed": arguments.name, "kind": kind})
    else:
        echo(f"{path} removed")
    return 0


def _find(name: str, kind: str | None) -> tuple[Kind, Path]:
    """Return the kind and the file of the key to remove."""
    signing, sealed = find_stored(name) is not None, sealed_key_path(name).is_file()
    if kind is None and signing and sealed:
        raise UsageError(
            f"there are a signing key and a key of sealed links with the name {name}: add --kind signing "
            "or --kind sealed"
        )
    if kind == Kind.SEALED or (kind is None and sealed):
        return Kind.SEALED, require_sealed(name)
    return Kind.SIGNING, require_stored(name)


def _signing_row(name: str) -> Row:
    try:
        return Row(name, Kind.SIGNING, load_stored_key(name).fingerprint, "")
    except (SigningError, MissingExtraError) as error:
        return Row(name, Kind.SIGNING, "", str(error))


def _sealed_row(name: str) -> Row:
    """Return the row of a key of sealed links; its fingerprint begins its public key."""
    try:
        from mavstack.security.sealed.keys import public_key, read_private_key

        return Row(name, Kind.SEALED, public_key(read_private_key(str(sealed_key_path(name)))).hex()[:16], "")
    except (SigningError, MissingExtraError) as error:
        return Row(name, Kind.SEALED, "", str(error))


def _for_programs(row: Row) -> dict[str, str | None]:
    return {
        "name": row.name,
        "kind": row.kind,
        "fingerprint": row.fingerprint or None,
        "problem": row.problem or None,
    }
