"""The MAVLink settings of a link URL: options that the node of the link applies, not the link itself.

    udpin://0.0.0.0:14550?signing_key=fleet&id=245/191&mavlink=auto&heartbeat_rate=2

A link only carries bytes, but a URL is where users say how to speak over it. `signing_key` and `mavlink`
apply to the channels of this link; `id` and `heartbeat_rate` apply to the whole node, so the links of one
node must not contradict each other. `mav` has an option for each, which applies to all links of the command.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.links.options import Options

#: The MAVLink version of sent packets; "auto": the version of the peer (see `mavstack.node.channel_state`).
Version: TypeAlias = Literal[1, 2, "auto"]

VERSIONS: Final[Mapping[str, Version]] = MappingProxyType({"1": 1, "2": 2, "auto": "auto"})
MAX_ID: Final = 255
#: Maximum heartbeat rate in hertz: a higher one would be a load for a telemetry radio.
MAX_HEARTBEAT_RATE: Final = 50.0
ADDRESS_FORMAT: Final = f"SYSTEM or SYSTEM/COMPONENT, each 1 to {MAX_ID}"
RATE_FORMAT: Final = f"a rate from 0 (none) to {MAX_HEARTBEAT_RATE:g} Hz"

_ADDRESS: Final = re.compile(r"([0-9]{1,3})(?:/([0-9]{1,3}))?")
_RATE: Final = re.compile(r"[0-9]{1,3}(?:\.[0-9]{1,9})?|\.[0-9]{1,9}")


@dataclass(frozen=True, slots=True)
class LinkSettings:
    """The MAVLink settings of one link; None or an empty text: the URL says nothing.

    Attributes:
        signing_key: File or name of the key that the link signs with.
        system: System id of the node.
        component: Component id of the node.
        version: MAVLink version of sent packets: 1, 2 or "auto".
        heartbeat_rate: Heartbeats of the node per second; 0: none.
    """

    signing_key: str = ""
    system: int | None = None
    component: int | None = None
    version: Version | None = None
    heartbeat_rate: float | None = None

    @classmethod
    def from_options(cls, options: Options) -> LinkSettings:
        """Read the settings from the options of a URL; raises `LinkURLError`."""
        address = options.parsed("id", parse_address, ADDRESS_FORMAT)
        system, component = address or (None, None)
        return cls(
            signing_key=options.text("signing_key"),
            system=system,
            component=component,
            version=options.parsed("mavlink", VERSIONS.__getitem__, "1, 2 or auto"),
            heartbeat_rate=options.parsed("heartbeat_rate", parse_heartbeat_rate, RATE_FORMAT),
        )

    @property
    def given(self) -> list[str]:
        """The names of the options that the URL has."""
        options = {"system": "id", "component": "id", "version": "mavlink"}
        given = [each.name for each in fields(self) if getattr(self, each.name) != each.default]
        return list(dict.fromkeys(options.get(name, name) for name in given))


def parse_address(text: str) -> tuple[int, int | None]:
    """Parse SYSTEM or SYSTEM/COMPONENT; raises ValueError."""
    match = _ADDRESS.fullmatch(text)
    numbers = [int(number) for number in match.groups() if number] if match else [0]
    if not all(1 <= number <= MAX_ID for number in numbers):
        raise ValueError
    return numbers[0], numbers[1] if len(numbers) > 1 else None


def parse_heartbeat_rate(text: str) -> float:
    """Parse a rate of heartbeats in hertz; raises ValueError."""
    if not _RATE.fullmatch(text) or float(text) > MAX_HEARTBEAT_RATE:
        raise ValueError
    return float(text)
