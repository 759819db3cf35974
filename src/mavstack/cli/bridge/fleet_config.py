"""`mav bridge zenoh config`: the configuration of a Zenoh router for a fleet, and its certificates."""

from __future__ import annotations

from argparse import ArgumentTypeError
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.zenoh.keys import DEFAULT_PREFIX, checked_name, checked_prefix
from mavstack.cli.common.output import echo
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

EXAMPLES: Final = (
    "mav bridge zenoh config fleet --vehicle alpha --vehicle beta --pilot tower --host ground.example",
    "mav bridge zenoh config fleet --gateway boat=alpha,beta --observer map --peer tls/10.1.0.1:7447",
)
_ROUTER: Final = "router"


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "folder", type=Path, metavar="FOLDER", help="gets the configuration and the certificates"
    )
    for option, summary in (
        ("--vehicle", "a vehicle whose gateway has its name"),
        ("--observer", "a station that reads all vehicles"),
        ("--pilot", "a station that controls all vehicles"),
        ("--router", "another router of the fleet"),
    ):
        parser.add_argument(option, action="append", type=_name, default=[], metavar="NAME", help=summary)
    parser.add_argument(
        "--gateway",
        action="append",
        type=_gateway,
        default=[],
        metavar="NAME=VEHICLES",
        help="a gateway, and the names of its vehicles with commas between them",
    )
    parser.add_argument(
        "--host",
        action="append",
        default=[],
        metavar="HOST",
        help="name or address under which the router is reached (default: localhost and 127.0.0.1)",
    )
    parser.add_argument(
        "--listen", metavar="ENDPOINT", help="the router listens there (default: tls/0.0.0.0:7447)"
    )
    parser.add_argument(
        "--peer", action="append", default=[], metavar="ENDPOINT", help="another router to connect to"
    )
    parser.add_argument(
        "--name", type=_name, default=_ROUTER, metavar="NAME", help=f"name of the router (default: {_ROUTER})"
    )
    parser.add_argument(
        "--prefix",
        type=partial(_checked, checked_prefix),
        default=DEFAULT_PREFIX,
        help=f"beginning of all keys (default: {DEFAULT_PREFIX})",
    )


def write_config(arguments: Namespace) -> int:
    """Run `mav bridge zenoh config`."""
    from mavstack.atomic_file import write_file_atomically
    from mavstack.bridges.zenoh.certificates import FleetCertificates
    from mavstack.bridges.zenoh.router_config import DEFAULT_LISTEN, Fleet, router_config

    gateways = {name: (name,) for name in arguments.vehicle} | dict(arguments.gateway)
    fleet = Fleet(
        gateways,
        tuple(arguments.observer),
        tuple(arguments.pilot),
        tuple(dict.fromkeys((arguments.name, *arguments.router))),
        arguments.prefix,
    )
    if not gateways:
        raise InvalidArgumentError("a fleet needs vehicles: --vehicle NAME, or --gateway NAME=VEHICLES")
    folder: Path = arguments.folder.resolve()
    certificates = FleetCertificates(folder)
    certificates.make(arguments.name, arguments.host or ["localhost", "127.0.0.1"])
    for owner in fleet.owners():
        certificates.make(owner)
    text = router_config(
        fleet,
        certificate=str(folder / f"{arguments.name}.pem"),
        private_key=str(folder / f"{arguments.name}.key"),
        ca=str(folder / "ca.pem"),
        listen=[arguments.listen or DEFAULT_LISTEN],
        connect=arguments.peer,
    )
    path = folder / f"{arguments.name}.json5"
    write_file_atomically(path, text)
    echo(*(str(each) for each in (*certificates.written, path)))
    return 0


def _checked(check: Any, *arguments: str) -> str:  # noqa: ANN401 (either check)
    try:
        return str(check(*arguments))
    except InvalidArgumentError as error:
        raise ArgumentTypeError(str(error)) from None


def _name(text: str) -> str:
    return _checked(checked_name, text, "a name")


def _gateway(text: str) -> tuple[str, tuple[str, ...]]:
    name, _, vehicles = text.partition("=")
    if not vehicles:
        raise ArgumentTypeError(f"must be NAME=VEHICLES such as boat=alpha,beta, got {text!r}")
    return _name(name), tuple(map(_name, vehicles.split(",")))
