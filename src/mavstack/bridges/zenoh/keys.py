"""The keys of a fleet on Zenoh. Pure functions, without Zenoh.

    <prefix>/<vehicle>/frame/out            packets of the vehicle as they are, several in a sample
    <prefix>/<vehicle>/frame/in             packets for it
    <prefix>/<vehicle>/message/<component>/<MESSAGE>    a message as JSON
    <prefix>/<vehicle>/state/<group>        a snapshot as JSON; late subscribers and queries get the last one
    <prefix>/<vehicle>/command/<name>       a queryable for a service or an action
    <prefix>/<vehicle>/alive/<gateway>      a liveliness token, while heartbeats of the vehicle arrive
    <prefix>/@gateway/<gateway>             a liveliness token of the gateway

A part of a key that begins with @ is matched by no wildcard, so gateways are not vehicles.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from mavstack.errors import InvalidArgumentError

DEFAULT_PREFIX: Final = "mavstack"
#: The prefix of the default vehicle name, which ends with the system id.
DEFAULT_NAME: Final = "sys"
_NAME: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,63}")
#: Direction, end of the key, and payload of each key, for the table of keys.
TABLE: Final = (
    ("from vehicle", "frame/out", "MAVLink packets as received, several in a sample"),
    ("from vehicle", "message/<component>/<MESSAGE>", "one message as JSON: name, ids, time, fields"),
    (
        "from vehicle",
        "state/<group>",
        "a snapshot as JSON; late subscribers and queries get the last one",
    ),
    ("to vehicle", "frame/in", "MAVLink packets, with --allow-control"),
    (
        "query",
        "command/<name>",
        "a service or an action of `mav bridge list`: JSON, also in the reply",
    ),
    ("liveliness", "alive/<gateway>", "exists while heartbeats of the vehicle arrive at the gateway"),
)


def checked_name(text: str, kind: str) -> str:
    """Return a name that is one part of a key.

    Args:
        text: The name.
        kind: The kind of name, for the error text.

    Raises:
        InvalidArgumentError: It is not such a name.
    """
    if not _NAME.fullmatch(text):
        raise InvalidArgumentError(f"{kind} must have letters, digits, _, - and ., got {text!r:.80}")
    return text


def checked_prefix(text: str) -> str:
    """Return a prefix of keys, without slashes at its ends.

    Raises:
        InvalidArgumentError: A part of it is not a name.
    """
    return "/".join(checked_name(part, "a prefix of keys") for part in text.strip("/").split("/"))


@dataclass(frozen=True, slots=True)
class VehicleKeys:
    """The keys of one vehicle; with the name `*` the expressions for all vehicles.

    Attributes:
        prefix: The prefix of the fleet.
        name: The name of the vehicle.
    """

    prefix: str
    name: str

    @property
    def root(self) -> str:
        """The beginning of all keys of the vehicle."""
        return f"{self.prefix}/{self.name}"

    @property
    def frames_out(self) -> str:
        """The key of packets of the vehicle."""
        return f"{self.root}/frame/out"

    @property
    def frames_in(self) -> str:
        """The key of packets for the vehicle."""
        return f"{self.root}/frame/in"

    @property
    def messages(self) -> str:
        """The expression of all messages."""
        return f"{self.root}/message/*/*"

    def message(self, component: int, name: str) -> str:
        """Return the key of a message of a component."""
        return f"{self.root}/message/{component}/{name}"

    def state(self, group: str) -> str:
        """Return the key of a group of the state."""
        return f"{self.root}/state/{group}"

    @property
    def commands(self) -> str:
        """The expression of all commands."""
        return f"{self.root}/command/**"

    def command(self, name: str) -> str:
        """Return the key of a command."""
        return f"{self.root}/command/{name}"

    def alive(self, gateway: str) -> str:
        """Return the liveliness token of the vehicle at a gateway."""
        return f"{self.root}/alive/{gateway}"


def gateway_key(prefix: str, gateway: str) -> str:
    """Return the liveliness token of a gateway; with the name `*` the expression for all."""
    return f"{prefix}/@gateway/{gateway}"


def parse_alive(prefix: str, key: str) -> tuple[str, str] | None:
    """Return the names of vehicle and gateway in a liveliness token; None if it is not one."""
    parts = key.removeprefix(f"{prefix}/").split("/")
    if not key.startswith(f"{prefix}/") or len(parts) != 3 or parts[1] != "alive":
        return None
    return parts[0], parts[2]


def vehicle_of(prefix: str, key: str) -> str:
    """Return the name of the vehicle in a key; empty if it is not a key of the fleet."""
    return key[len(prefix) + 1 :].partition("/")[0] if key.startswith(f"{prefix}/") else ""


def command_of(key: str) -> str:
    """Return the name of the command in the key of a query; empty if it is an expression for several."""
    name = key.partition("/command/")[2]
    return "" if "*" in name or "$" in name else name
