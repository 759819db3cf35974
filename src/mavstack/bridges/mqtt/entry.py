"""The entry of the bridge to MQTT: its options."""

from __future__ import annotations

import dataclasses
import re
from argparse import ArgumentTypeError
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.naming_options import add_names_option
from mavstack.bridges.core.registry import BridgeEntry
from mavstack.bridges.mqtt.broker import Broker
from mavstack.bridges.mqtt.home_assistant import DEFAULT_PREFIX
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator

    from mavstack.vehicle import Connection

_EXAMPLES: Final = (
    "mav bridge mqtt udpin://0.0.0.0:14550 --broker mqtt://127.0.0.1:1883",
    "mav bridge mqtt udpin://0.0.0.0:14550 --broker mqtts://user:password@broker.example --rate 5",
    "mav bridge mqtt udpin://0.0.0.0:14550 --broker mqtt://127.0.0.1 --home-assistant --allow-control",
)
_RATES: Final = (1.0, 5.0)
_PREFIX: Final = re.compile(r"[^+#/$\0\s][^+#\0\s]{0,99}")


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add(
        "--broker",
        type=broker_url,
        required=True,
        metavar="URL",
        help="mqtt://HOST:1883 or mqtts://HOST:8883",
    )
    add("--ca", default="", metavar="FILE", help="certificate of the authority, for mqtts (default: system)")
    add("--prefix", type=topic_prefix, default="mavstack", metavar="TOPIC", help="before all topics")
    add("--rate", type=_rate, default=2.0, metavar="HZ", help="telemetry per second, 1 to 5 (default: 2)")
    add_names_option(parser)
    add(
        "--home-assistant",
        nargs="?",
        type=topic_prefix,
        const=DEFAULT_PREFIX,
        metavar="TOPIC",
        help=f"describe the vehicles for Home Assistant (below {DEFAULT_PREFIX} unless another one is named)",
    )


@asynccontextmanager
async def serve(arguments: Namespace, connection: Connection) -> AsyncIterator[str]:
    """Run the bridge; its value is the line that says that it is ready."""
    from mavstack.bridges.mqtt.bridge import MqttBridge
    from mavstack.bridges.mqtt.vehicle_topics import MqttOptions

    broker = dataclasses.replace(arguments.broker, authority=arguments.ca)
    discovery = arguments.home_assistant or ""
    options = MqttOptions(broker, arguments.prefix, arguments.rate, arguments.role, discovery)
    async with MqttBridge(connection, options, dict(arguments.name)):
        yield f"MQTT {broker}, topics below {arguments.prefix}/"


def broker_url(text: str) -> Broker:
    """Return the broker of an option."""
    try:
        return Broker.parse(text)
    except InvalidArgumentError as error:
        raise ArgumentTypeError(str(error)) from None


def topic_prefix(text: str) -> str:
    """Return the beginning of topics of an option, without slashes at its ends."""
    text = text.strip("/")
    if not _PREFIX.fullmatch(text):
        raise ArgumentTypeError(f"must be a topic without wildcards and spaces, got {text!r:.40}")
    return text


def _rate(text: str) -> float:
    lowest, highest = _RATES
    try:
        rate = float(text)
    except ValueError:
        rate = 0.0
    if not lowest <= rate <= highest:
        raise ArgumentTypeError(f"must be from {lowest:g} to {highest:g} Hz, got {text!r:.20}")
    return rate


ENTRY: Final = BridgeEntry("vehicles as JSON on MQTT, for Home Assistant too", _EXAMPLES, add_options, serve)
