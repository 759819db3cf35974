"""The JSON of several vehicles that use one system id."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.services.heartbeat import describe_component

if TYPE_CHECKING:
    from mavstack.services.heartbeat import Conflict, ConflictingSender
    from mavstack.vehicle import Vehicle


def conflict_json(vehicle: Vehicle) -> dict[str, Any] | None:
    """Return the vehicles that use the system id of a vehicle as JSON; None if it is the only one."""
    conflict = vehicle.id_conflict
    if conflict is None:
        return None
    chosen = vehicle.chosen_sender
    chosen = chosen if chosen is not None and conflict.is_separate(chosen) else None
    count = len(conflict.senders)
    return {
        "text": f"{count} vehicles use system id {vehicle.system}: {conflict}",
        "differs": list(conflict.differs),
        "senders": [_sender_json(each, conflict, chosen) for each in conflict.senders],
        "chosen": chosen,
    }


def _sender_json(sender: ConflictingSender, conflict: Conflict, chosen: str | None) -> dict[str, Any]:
    own = [name for name in sender.channels if conflict.is_separate(name)]
    known, position = sender.type_and_autopilot, sender.position
    place = None if position is None else {"latitude": position[0], "longitude": position[1]}
    return {
        "channel": own[0] if own else None,
        "channels": list(sender.channels),
        "remote": (own[0].partition(" ")[2] or own[0]) if own else None,
        "type": None if known is None else describe_component(*known),
        "unique_id": sender.unique_id or None,
        "booted_at": sender.booted_at,
        "position": place,
        "chosen": chosen is not None and chosen in sender.channels,
    }
