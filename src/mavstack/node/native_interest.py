"""The interest of the services of a node in messages of a source, by which the core leaves packets out."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.node.message_fields import BOOT_FIELDS
from mavstack.services import message_ids

if TYPE_CHECKING:
    from mavstack.node.host import NodeHost

_RADIO_STATUS: Final = message_ids(common.RadioStatus)
#: Messages that are sent regularly or without a request: there is no need to read them at once.
_UNHURRIED: Final = message_ids(common.Heartbeat, common.GlobalPositionInt, common.Statustext)


class Level(IntEnum):
    """The interest of the node in a message of a source, as the core numbers it."""

    NOTHING = 1
    NEW_BOOT = 2
    SOON = 3
    NOW = 4


def interest_of_services(host: NodeHost, source: tuple[int, int], message_id: int) -> Level:
    """Return the interest of services in a message of a source."""
    discovery = host.discovery
    services = host.engine.service_index.find(message_id, source[0])
    others = [service for service in services if service is not discovery]
    if others:
        return Level.SOON if message_id in _UNHURRIED else Level.NOW
    if services:
        return Level.NEW_BOOT if message_id in BOOT_FIELDS else Level.SOON
    return Level.SOON if message_id in _RADIO_STATUS else Level.NOTHING
