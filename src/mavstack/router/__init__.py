"""The router: one process that joins serial, UDP, TCP, WebSocket, Unix and other links.

The packets are forwarded by the native engine (`engine.py`); everything here decides: which endpoints there
are, which filters they have, what is recorded and told.
"""

from mavstack.router.engine import RouterEngine
from mavstack.router.engine_events import RouterEvent
from mavstack.router.engine_statistics import (
    EndpointStatistics,
    PeerState,
    Route,
    RouterStatistics,
    RuleCounts,
    SourceCounts,
)
from mavstack.router.rules import Action, Rule, RuleSet

__all__ = [
    "Action",
    "EndpointStatistics",
    "PeerState",
    "Route",
    "RouterEngine",
    "RouterEvent",
    "RouterStatistics",
    "Rule",
    "RuleCounts",
    "RuleSet",
    "SourceCounts",
]
