"""The same node for scripts that block: `with mavstack.sync.Node(url) as node: vehicle = node.autopilot()`.

Every name, argument, result and error is that of `mavstack.node`; see `proxy` for how.
"""

from mavstack.sync.node import Node

__all__ = ["Node"]
