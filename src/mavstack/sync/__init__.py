"""The same for scripts that block: `with mavstack.sync.connect(url) as node: vehicle = node.wait_for_vehicle()`.

Every name, argument, result and error is that of `mavstack.vehicle` and `mavstack.node`; see `proxy` for how.
"""

from mavstack.sync.node import Connection, Node, connect

__all__ = ["Connection", "Node", "connect"]
