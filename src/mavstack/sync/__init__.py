"""The blocking API, for scripts.

    with mavstack.sync.connect("udpin://0.0.0.0:14550") as connection:
        vehicle = connection.wait_for_vehicle()

Every name, argument, result and error is that of the async API (`mavstack.node`, `mavstack.vehicle`); calls
block in place of `await`. The classes can be imported for annotations and `isinstance`, as in `from
mavstack.sync import Vehicle`.
"""

from __future__ import annotations

from mavstack.sync.classes import wrapped_classes
from mavstack.sync.node import Connection, Node, connect
from mavstack.sync.proxy import Blocking, class_named

__all__ = ["Connection", "Node", "connect"]
__all__ += [name for name in wrapped_classes() if name not in __all__]


def __getattr__(name: str) -> type[Blocking]:
    if name in wrapped_classes():
        return class_named(name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
