"""PX4's events: it sends them beside status texts, which it marks by a tab, so each follows from its text."""

from __future__ import annotations

import re
import struct
from typing import TYPE_CHECKING, Final

from mavstack.services.events import EventSender
from mavstack.sim.event_metadata import EVENTS, MODE_NUMBERS, REASONS, UNKNOWN_MODE

if TYPE_CHECKING:
    from mavstack.sim.event_metadata import SimulatedEvent
    from mavstack.sim.vehicle import SimulatedVehicle

_PATTERNS: Final = tuple((event, re.compile(event.status_text)) for event in EVENTS)


class EventReporter:
    """The sender of one vehicle's events."""

    def __init__(self) -> None:
        self._sender: EventSender | None = None

    def start(self, vehicle: SimulatedVehicle) -> None:
        """Begin a new series of events at boot, and listen to the vehicle."""
        self._sender = vehicle.engine.add(EventSender(vehicle.address, vehicle.now))
        vehicle.add_listener(self.on_event)

    def on_event(self, vehicle: SimulatedVehicle, kind: str, text: str) -> None:
        """Send the event of a status text, if it has one."""
        if kind != "text" or self._sender is None:
            return
        found = find_event(text)
        if found is not None:
            event, groups = found
            self._sender.report(
                event.id,
                vehicle.now,
                arguments=_arguments(vehicle, groups),
                level=event.level,
                internal_level=event.internal_level,
            )
            vehicle.touch(self._sender)


def find_event(text: str) -> tuple[SimulatedEvent, dict[str, str]] | None:
    """Return the event of a status text, and the words that give its arguments; None if it has none."""
    for event, pattern in _PATTERNS:
        found = pattern.fullmatch(text)
        if found is not None:
            return event, found.groupdict()
    return None


def _arguments(vehicle: SimulatedVehicle, groups: dict[str, str]) -> bytes:
    """Return the arguments that the groups of a status text give."""
    if "reason" in groups:
        return bytes([REASONS.get(groups["reason"], 0)])
    if "value" in groups:
        return struct.pack("<f", float(groups["value"]))
    if "mode" in groups:
        modes = {mode.name: mode.number for mode in vehicle.profile.modes}
        number = modes.get(groups["mode"], 0)
        main, sub = number >> 16 & 0xFF, number >> 24 & 0xFF
        return struct.pack("<IB", number, MODE_NUMBERS.get((main, sub), UNKNOWN_MODE))
    return b""
