"""The services and actions of the table, without transport."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.services import commands, files, flight, logs, parameters, payloads, plans

if TYPE_CHECKING:
    from mavstack.bridges.core.row import Action, Service

SERVICES: Final[tuple[Service, ...]] = (
    *commands.ROWS,
    *plans.ROWS,
    *parameters.ROWS,
    *files.ROWS,
    *logs.ROWS,
    *payloads.ROWS,
)
ACTIONS: Final[tuple[Action, ...]] = flight.ROWS

__all__ = ["ACTIONS", "SERVICES"]
