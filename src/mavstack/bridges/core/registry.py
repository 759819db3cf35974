"""The bridges of `mav bridge`, by name: each is one package and one entry here.

Other packages add theirs through the entry points `mavstack.bridges`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from mavstack.plugins import Registry

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Mapping
    from contextlib import AbstractAsyncContextManager

    from mavstack.vehicle import Connection


@dataclass(frozen=True, slots=True)
class BridgeEntry:
    """One bridge.

    Attributes:
        summary: One line about it.
        examples: Command lines, each with a comment.
        add_options: Declares its options; `--allow-control`, `--role` and those of links are there already.
        serve: Returns an async context manager for the parsed options and the open connection: the bridge
            runs inside it. Its value is the line that says that the bridge is ready. The role of the buses
            is `role` of the options (`mavstack.security.roles.Role`).
        identity: The arguments of `connect` that say what the bridge is on MAVLink; empty: a ground station.
    """

    summary: str
    examples: tuple[str, ...]
    add_options: Callable[[ArgumentParser], None]
    serve: Callable[[Namespace, Connection], AbstractAsyncContextManager[str]]
    identity: Mapping[str, int] = field(default_factory=dict)


BRIDGES: Final[Registry[BridgeEntry]] = Registry(
    "bridge",
    "mavstack.bridges",
    {
        "ros2": "mavstack.bridges.ros2.entry:ENTRY",
        "foxglove": "mavstack.bridges.foxglove.entry:ENTRY",
        "mcap": "mavstack.bridges.mcap.entry:ENTRY",
        "mqtt": "mavstack.bridges.mqtt.entry:ENTRY",
        "otel": "mavstack.bridges.otel.entry:ENTRY",
        "prometheus": "mavstack.bridges.prometheus.entry:ENTRY",
        "zenoh": "mavstack.bridges.zenoh.entry:ENTRY",
    },
)
