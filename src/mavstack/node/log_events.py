"""Log records of a node's events, by the logger `mavstack.node`; links log their own by `mavstack.links`.

Keys never appear: of a change of keys, only the peer and the outcome are logged.
"""

from __future__ import annotations

import logging

from mavstack.services.heartbeat import (
    AddressConflict,
    AddressConflictEnded,
    ComponentChanged,
    ComponentFound,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
    OwnAddressConflict,
)
from mavstack.services.signing_setup import KeySettled

_logger = logging.getLogger("mavstack.node")


def log_event(event: object) -> None:
    """Log an event, if it is about the presence of a component, an address conflict or a signing key."""
    match event:
        case ComponentFound(component):
            _logger.info("component %s found: %s", component.address, component.description)
        case ComponentLost(component, reason):
            _logger.warning("component %s lost: %s", component.address, reason)
        case ComponentReturned(component, after):
            _logger.info("component %s returned after %.1f s", component.address, after)
        case ComponentChanged(component):
            _logger.info("component %s changed: %s", component.address, component.description)
        case ComponentRebooted(component):
            _logger.warning("component %s rebooted", component.address)
        case AddressConflict(component):
            _logger.warning("address conflict: several senders use %s", component.address)
        case AddressConflictEnded(component):
            _logger.info("address conflict of %s ended", component.address)
        case OwnAddressConflict(component):
            _logger.warning("address conflict: another sender uses this node's address %s", component.address)
        case KeySettled(peer=peer, changed=changed):
            _logger.info("signing key of %s %s", peer, "changed" if changed else "unchanged")
