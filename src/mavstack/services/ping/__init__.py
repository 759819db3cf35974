"""The ping protocol: round-trip times to a component (guide: PING protocol)."""

from mavstack.services.ping.client import PingClient, PingOperation
from mavstack.services.ping.server import PingServer
from mavstack.services.ping.statistics import PingStatistics

__all__ = ["PingClient", "PingOperation", "PingServer", "PingStatistics"]
