"""The router: one process that joins serial, UDP, TCP, WebSocket, Unix and other links.

The packets are forwarded by the native engine (`engine.py`); everything here decides: which endpoints there
are, which filters they have, what is recorded and told. The classes of statistics are imported when they are
used: a router without a control API needs less memory.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.router.engine import RouterEngine
from mavstack.router.engine_events import RouterEvent
from mavstack.router.rules import Action, Rule, RuleSet

if TYPE_CHECKING:
    from mavstack.router.engine_statistics import (
        EndpointStatistics,
        PeerState,
        Route,
        RouterStatistics,
        RuleCounts,
        SourceCounts,
    )

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


def __getattr__(name: str) -> Any:  # noqa: ANN401 (any of the names above)
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from mavstack.router import engine_statistics

    return getattr(engine_statistics, name)
