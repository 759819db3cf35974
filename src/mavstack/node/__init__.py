"""The node: what makes a program a MAVLink component, on asyncio and links."""

from mavstack.node.key_change import trusted_channels
from mavstack.node.node import Node
from mavstack.node.component import RemoteComponent
from mavstack.node.subscription import Subscription

__all__ = ["Node", "RemoteComponent", "Subscription", "trusted_channels"]
