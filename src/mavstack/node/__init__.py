"""The node layer: a program as a MAVLink component, on asyncio and links."""

from mavstack.node.component import RemoteComponent
from mavstack.node.dispatch import Listener
from mavstack.node.events import EventListener, EventStream
from mavstack.node.node import Node
from mavstack.node.subscription import Subscription

__all__ = ["EventListener", "EventStream", "Listener", "Node", "RemoteComponent", "Subscription"]
