"""The entry of the bridge of fleets over Zenoh: its options, and the gateway that they describe."""

from __future__ import annotations

import platform
from argparse import ArgumentTypeError
from contextlib import AsyncExitStack, asynccontextmanager
from secrets import token_hex
from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.registry import BridgeEntry
from mavstack.bridges.core.zenoh_session import DEFAULT_ROUTER, SessionOptions
from mavstack.bridges.zenoh.gateway import BATCH_TIME, STATE_RATE, GatewayOptions
from mavstack.bridges.zenoh.keys import DEFAULT_PREFIX, checked_name, checked_prefix
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator, Callable

    from mavstack.vehicle import Connection

_EXAMPLES: Final = (
    "mav bridge zenoh udpin://0.0.0.0:14550   # a fleet over the Zenoh router of this machine",
    "mav bridge zenoh udpin://0.0.0.0:14550 --connect tcp/ground.example:7447 --allow-control --name 1=alpha",
    "mav bridge zenoh /dev/ttyACM0 --connect tls/tower:7447 --tls-ca ca.pem --tls-cert a.pem --tls-key a.key",
    "mav bridge zenoh udpin://0.0.0.0:14550 --mavlink-server   # its keys too",
)
#: The MAVLink identity of a gateway, which is not a ground station because vehicles monitor the heartbeats of
#: ground stations.
IDENTITY: Final = {
    "system": 254,
    "component": int(common.MavComponent.ONBOARD_COMPUTER),
    "type": int(common.MavType.ONBOARD_CONTROLLER),
}


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add(
        "--connect",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help=f"the Zenoh router, may be repeated (default: {DEFAULT_ROUTER})",
    )
    add(
        "--prefix",
        type=_checked(checked_prefix),
        default=DEFAULT_PREFIX,
        metavar="PREFIX",
        help=f"beginning of all keys (default: {DEFAULT_PREFIX})",
    )
    add(
        "--name",
        action="append",
        type=_vehicle_name,
        default=[],
        metavar="ID=NAME",
        help="name of a vehicle by its system id (default: sys and the id)",
    )
    add(
        "--gateway",
        type=_checked(lambda text: checked_name(text, "the name of a gateway")),
        metavar="NAME",
        help="name of this gateway (default: the name of the machine and a random number)",
    )
    add("--tls-ca", metavar="FILE", default="", help="authority of the router's certificate")
    add("--tls-cert", metavar="FILE", default="", help="own certificate, which the router knows")
    add("--tls-key", metavar="FILE", default="", help="private key of the own certificate")
    add(
        "--state-rate",
        type=_positive,
        default=STATE_RATE,
        metavar="HZ",
        help=f"snapshots of the state per second (default: {STATE_RATE:g})",
    )
    add(
        "--batch-time",
        type=_milliseconds,
        default=BATCH_TIME,
        metavar="MS",
        help=f"milliseconds that packets wait for others (default: {BATCH_TIME * 1000:g})",
    )
    add("--mavlink-server", action="store_true", help="publish with the keys of mavlink-server too")


@asynccontextmanager
async def serve(arguments: Namespace, connection: Connection) -> AsyncIterator[str]:
    """Run the gateway; its value is the line that says that it is ready."""
    from mavstack.bridges.zenoh.bus import Bus
    from mavstack.bridges.zenoh.gateway import Gateway
    from mavstack.bridges.zenoh.mavlink_server import MavlinkServerKeys

    if bool(arguments.tls_cert) != bool(arguments.tls_key):
        raise InvalidArgumentError("--tls-cert and --tls-key need each other")
    routers = tuple(arguments.connect) or (DEFAULT_ROUTER,)
    session = SessionOptions(
        routers, ca=arguments.tls_ca, certificate=arguments.tls_cert, private_key=arguments.tls_key
    )
    options = GatewayOptions(
        arguments.prefix,
        dict(arguments.name),
        arguments.role,
        batch_time=arguments.batch_time,
        state_rate=arguments.state_rate,
    )
    bus = Bus(session, arguments.gateway or f"{_host_name()}-{token_hex(2)}")
    async with AsyncExitStack() as stack:
        await stack.enter_async_context(Gateway(connection, bus, options))
        if arguments.mavlink_server:
            stack.enter_context(MavlinkServerKeys(connection, bus, arguments.role))
        yield f"fleet {arguments.prefix} on Zenoh by {', '.join(routers)}"


def _host_name() -> str:
    kept = "".join(letter if letter.isalnum() or letter in "-_" else "-" for letter in platform.node())
    return kept.strip("-")[:32] or "gateway"


def _checked(check: Callable[[str], str]) -> Callable[[str], str]:
    def convert(text: str) -> str:
        try:
            return check(text)
        except InvalidArgumentError as error:
            raise ArgumentTypeError(str(error)) from None

    return convert


def _vehicle_name(text: str) -> tuple[int, str]:
    number, _, name = text.partition("=")
    if not number.isdecimal() or not name:
        raise ArgumentTypeError(f"must be ID=NAME such as 1=alpha, got {text!r}")
    return int(number), _checked(lambda each: checked_name(each, "the name of a vehicle"))(name)


def _positive(text: str) -> float:
    value = _number(text)
    if not 0 < value <= 100:
        raise ArgumentTypeError(f"must be above 0, at most 100, got {text}")
    return value


def _milliseconds(text: str) -> float:
    value = _number(text)
    if not 0 <= value <= 1000:
        raise ArgumentTypeError(f"must be from 0 to 1000, got {text}")
    return value / 1000


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ArgumentTypeError(f"must be a number, got {text!r}") from None


ENTRY: Final = BridgeEntry(
    summary="show a fleet on Zenoh: packets, messages, states, commands",
    examples=_EXAMPLES,
    add_options=add_options,
    serve=serve,
    identity=IDENTITY,
)
