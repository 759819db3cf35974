"""The node: what makes a program a MAVLink component."""

from mavstack.node.engine import Engine

__all__ = ["Engine"]
