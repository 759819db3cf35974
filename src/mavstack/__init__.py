"""The whole MAVLink system: `mavstack.connect`, `Dialect`, `Parser`, `open_log` and the rest.

Names are imported on first use, so that `import mavstack` costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any

    from mavstack.dialects import Dialect, Message
    from mavstack.errors import MavstackError
    from mavstack.links import open_link
    from mavstack.logs import LogFile, open_log
    from mavstack.node import Node
    from mavstack.security import SigningKey
    from mavstack.vehicle import connect
    from mavstack.wire import Encoder, Packet, Parser, Signing, encode

__version__ = "0.1.0"

__all__ = [
    "Dialect",
    "Encoder",
    "LogFile",
    "MavstackError",
    "Message",
    "Node",
    "Packet",
    "Parser",
    "Signing",
    "SigningKey",
    "connect",
    "encode",
    "open_link",
    "open_log",
]

_HOMES = {
    "Dialect": "mavstack.dialects",
    "Encoder": "mavstack.wire",
    "LogFile": "mavstack.logs",
    "MavstackError": "mavstack.errors",
    "Message": "mavstack.dialects",
    "Node": "mavstack.node",
    "Packet": "mavstack.wire",
    "Parser": "mavstack.wire",
    "Signing": "mavstack.wire",
    "SigningKey": "mavstack.security",
    "connect": "mavstack.vehicle",
    "encode": "mavstack.wire",
    "open_link": "mavstack.links",
    "open_log": "mavstack.logs",
}


def __getattr__(name: str) -> Any:  # noqa: ANN401 (any of the names above)
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'mavstack' has no attribute {name!r}")
    value = getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))
