"""`mav bridge list`: the mapping table as text or JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.bridges.core.row import Action, Publication, Service, Subscription
from mavstack.bridges.core.table import ALL
from mavstack.bridges.zenoh.keys import TABLE
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.wrapping import rows_that_fit
from mavstack.services.message_request.interval import name_of

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.bridges.core.row import Row

_KINDS = {Publication: "from vehicle", Subscription: "to vehicle", Service: "service", Action: "action"}


def print_table(arguments: Namespace) -> int:
    """Run `mav bridge list`."""
    if arguments.bus == "zenoh":
        return _print_keys(as_json=arguments.json)
    if arguments.json:
        echo_json([row_fields(row) for row in ALL])
        return 0
    cells = [_cells(row_fields(row)) for row in ALL]
    head = ("NAME", "KIND", "TYPE", "MAVLINK")
    echo(*rows_that_fit(head, cells))
    echo(f"{len(ALL)} rows; names without a slash are below /mavros; --json has units, frames and profiles")
    return 0


def _print_keys(*, as_json: bool) -> int:
    """Print the keys of a fleet on Zenoh."""
    head = ("KEY", "KIND", "CONTENT")
    rows = [(f"<prefix>/<vehicle>/{end}", kind, content) for kind, end, content in TABLE]
    if as_json:
        echo_json([dict(zip(map(str.lower, head), row, strict=True)) for row in rows])
        return 0
    echo(*rows_that_fit(head, rows))
    return 0


def row_fields(row: Row) -> dict[str, Any]:
    """Return a row as JSON: name, kind, type and what belongs to its kind."""
    found: dict[str, Any] = {"name": row.name, "kind": _KINDS[type(row)], "type": row.type}
    if isinstance(row, Publication | Subscription):
        found["qos"] = row.qos.name
        messages = row.sources if isinstance(row, Publication) else row.targets
        found["messages"] = [name_of(message) for message in messages]
    if not isinstance(row, Publication):
        found["role"] = row.role.word
    if isinstance(row, Service | Action):
        found["required"] = list(row.required)
    found["meaning"] = row.meaning
    if not isinstance(row, Action):
        found["difference"] = row.difference
    return found


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    package, _, name = row["type"].split("/")
    source = ", ".join(row.get("messages", ())) or row["meaning"]
    return row["name"], row["kind"], f"{package}/{name}", source
