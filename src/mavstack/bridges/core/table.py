"""The mapping table: all rows, in the order of the documentation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.row import Action, Publication, Service, Subscription
from mavstack.bridges.core.rows import debug_values, devices, inbound, lists, motion, position, sensors, state
from mavstack.bridges.core.services import ACTIONS, SERVICES

if TYPE_CHECKING:
    from mavstack.bridges.core.row import Row

PUBLICATIONS: Final[tuple[Publication, ...]] = (
    *state.ROWS,
    *motion.ROWS,
    *position.ROWS,
    *sensors.ROWS,
    *devices.ROWS,
    *debug_values.ROWS,
    *lists.ROWS,
)
SUBSCRIPTIONS: Final[tuple[Subscription, ...]] = inbound.ROWS
ALL: Final[tuple[Row, ...]] = (*PUBLICATIONS, *SUBSCRIPTIONS, *SERVICES, *ACTIONS)

__all__ = ["ACTIONS", "ALL", "PUBLICATIONS", "SERVICES", "SUBSCRIPTIONS", "Action", "Service"]
