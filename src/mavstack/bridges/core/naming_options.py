"""Options that bridges share: names of vehicles, ports, and the bridge that they describe."""

from __future__ import annotations

from argparse import ArgumentTypeError
from ipaddress import ip_address
from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.bridge import DEFAULT_NAME, Bridge
from mavstack.bridges.core.names import VehicleNames, checked_namespace
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.bridges.core.sink import Sink
    from mavstack.vehicle import Connection

MAX_PORT: Final = 65535


def add_naming_options(parser: ArgumentParser) -> None:
    """Declare `--namespace`, `--fleet` and `--name`."""
    add = parser.add_argument
    add(
        "--namespace",
        type=_namespace,
        default="",
        metavar="NAME",
        help="namespace before /mavros (default: none)",
    )
    add("--fleet", action="store_true", help="each vehicle has its name before /mavros, also a single one")
    add_names_option(parser, ", with --fleet (default: uav and the id)")


def add_names_option(parser: ArgumentParser, details: str = " (default: uav and the id)") -> None:
    """Declare `--name`; its value is a list of system ids with names."""
    parser.add_argument(
        "--name",
        action="append",
        type=vehicle_name,
        default=[],
        metavar="ID=NAME",
        help=f"name of a vehicle by its system id{details}",
    )


def make_bridge(connection: Connection, sink: Sink, arguments: Namespace) -> Bridge:
    """Return the bridge of a connection to a sink, with the names and the role of the options."""
    return Bridge(
        connection,
        [sink],
        namespace=arguments.namespace,
        fleet=arguments.fleet,
        vehicle_names=dict(arguments.name),
        role=arguments.role,
    )


def first_namespace(arguments: Namespace) -> str:
    """Return the namespace of the rows of the first vehicle, such as "/mavros" or "/alpha/mavros"."""
    names = [name for _, name in arguments.name]
    if names or arguments.fleet:
        return VehicleNames(arguments.namespace + (names[0] if names else f"/{DEFAULT_NAME}1")).namespace
    return VehicleNames(arguments.namespace).namespace


def vehicle_name(text: str) -> tuple[int, str]:
    """Return the system id and the name of a vehicle, for argparse."""
    number, _, name = text.partition("=")
    if not number.isdecimal() or not name:
        raise ArgumentTypeError(f"must be ID=NAME such as 1=alpha, got {text!r}")
    return int(number), _namespace(name)


def port_number(text: str) -> int:
    """Return a port, for argparse."""
    if not text.isdecimal() or int(text) > MAX_PORT:
        raise ArgumentTypeError(f"must be from 0 to {MAX_PORT}, got {text!r:.20}")
    return int(text)


def url_host(host: str) -> str:
    """Return an address as URLs have it."""
    try:
        return f"[{host}]" if ip_address(host).version == 6 else host
    except ValueError:
        return host


def _namespace(text: str) -> str:
    try:
        return checked_namespace(text)
    except InvalidArgumentError as error:
        raise ArgumentTypeError(str(error)) from None
