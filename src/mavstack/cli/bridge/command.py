"""`mav bridge`: vehicles on the buses of robotics, from the registry of bridges."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.registry import BRIDGES
from mavstack.cli.bridge import check, fleet_config
from mavstack.cli.bridge.listing import print_table
from mavstack.cli.common.actions import Actions
from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.link_options import add_link_options, with_link_options
from mavstack.cli.common.output import echo
from mavstack.security.roles import Role
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from contextlib import AbstractAsyncContextManager

    from mavstack.bridges.core.registry import BridgeEntry
    from mavstack.vehicle import Connection

_OTHERS: Final = (
    *fleet_config.EXAMPLES,
    *check.EXAMPLES,
    "mav bridge list                                       # the mapping table",
    "mav bridge list --json",
    "mav bridge list zenoh                                 # the keys of a fleet",
    "mav bridge package mavstack_msgs ~/ros_ws/src         # its interfaces as a ROS package",
)
_NOTE: Final = """
A bridge only observes unless --allow-control is given. It runs until Ctrl-C.
"""
#: Seconds for which received packets may wait, so that several are handled together at a high packet rate.
#: The event loop adds up to a millisecond, for it waits for whole ones.
_INPUT_INTERVAL: Final = 0.0015
_ROLES: Final = tuple(role.word for role in Role if role is not Role.OBSERVE)


def _examples() -> str:
    lines = [line for _, entry in BRIDGES.items() for line in entry.examples]
    return "\n".join(["examples:", *(f"  {line}" for line in (*lines, *_OTHERS)), _NOTE])


EXAMPLES: Final = _examples()


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions: one for each bridge, and those about the table."""
    actions = Actions(parser, "bridge", EXAMPLES)
    for name, entry in BRIDGES.items():
        _add_bridge(actions, name, entry)
    fleet_config.add_options(
        actions.add(
            "zenoh config", "write the configuration and certificates of a router", fleet_config.write_config
        )
    )
    text = "who is connected with the vehicles on a bus, and why others are not"
    check.add_options(actions.add("check", text, check.check))
    action = actions.add("list", "show the mapping table: topics, services, actions", print_table)
    action.add_argument(
        "bus", nargs="?", choices=("ros2", "zenoh"), default="ros2", help="the rows, or the keys of a fleet"
    )
    action.add_argument("--json", action="store_true", help="print a JSON array with one object per row")
    action = actions.add("package", "write the interfaces of a ROS package, to be built there", _package)
    action.add_argument("name", metavar="NAME", help="such as mavstack_msgs or mavros_msgs")
    action.add_argument("folder", type=Path, metavar="FOLDER", help="gets the folder of the package")


def _add_bridge(actions: Actions, name: str, entry: BridgeEntry) -> None:
    parser = actions.add(name, entry.summary, _serve)
    parser.set_defaults(bridge=name)
    parser.add_argument("urls", nargs="+", metavar="URL", help="link to vehicles")
    entry.add_options(parser)
    parser.add_argument(
        "--allow-control", action="store_true", help="pass requests and setpoints of the bus to vehicles"
    )
    parser.add_argument(
        "--role",
        choices=_ROLES,
        default=_ROLES[-1],
        help="with --allow-control: what the bus may do (default: administer)",
    )
    parser.add_argument(
        "--otlp", metavar="URL", help="export spans of operations to OpenTelemetry: http://127.0.0.1:4318"
    )
    add_link_options(parser.add_argument_group("links"))


def _serve(arguments: Namespace) -> int:
    entry = BRIDGES.get(arguments.bridge)
    arguments.role = Role.from_word(arguments.role) if arguments.allow_control else Role.OBSERVE

    async def serve() -> int:
        identity: Any = entry.identity
        urls = with_link_options(arguments.urls, arguments)
        async with connect(*urls, input_interval=_INPUT_INTERVAL, **identity) as connection:
            announce_exposure("bridge", connection.links)
            async with (
                _exported_spans(arguments.otlp, connection),
                entry.serve(arguments, connection) as line,
            ):
                control = "control allowed" if arguments.allow_control else "read only"
                echo(f"{line}; {control}; Ctrl-C to end")
                await connection.serve_forever()
        return 0

    return run_until_signal(serve())


def _exported_spans(url: str | None, connection: Connection) -> AbstractAsyncContextManager[object]:
    """Return a context in which the operations of a connection are exported, if a URL is given."""
    if url is None:
        return nullcontext()
    from mavstack.bridges.otel.exporting import exported_spans

    return exported_spans(url, connection)


def _package(arguments: Namespace) -> int:
    from mavstack.bridges.core.types.package import write_package

    echo(str(write_package(arguments.name, arguments.folder)))
    return 0
