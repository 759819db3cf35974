"""The monitor of one vehicle's mode: the current one, the commanded one, and changes of its set of modes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.modes.names import listed_name, mode_name
from mavstack.services.service import Event, Service

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: The largest number of modes: AVAILABLE_MODES counts them in one byte.
MAX_REPORTED = 255


@dataclass(frozen=True, slots=True)
class ModeSeen(Event):
    """The vehicle entered another mode; `name` is None if its number has no known name."""

    custom_mode: int
    name: str | None


@dataclass(frozen=True, slots=True)
class ModesOutdated(Event):
    """The vehicle's set of modes changed; list them again."""

    sequence: int


class ModeMonitor(Service):
    """The mode of one vehicle, from its HEARTBEAT and CURRENT_MODE."""

    handles = message_ids(
        common.Heartbeat, common.CurrentMode, common.AvailableModes, common.AvailableModesMonitor
    )

    def __init__(self, local: Address, target: Address) -> None:
        super().__init__(local)
        self.target = self.source_filter = target
        self.custom_mode: int | None = None
        self.standard_mode: int | None = None
        self.intended: int | None = None
        #: The names of the modes that the vehicle listed, by custom mode number.
        self.reported: dict[int, str] = {}
        self._sequence = 0
        self._kind = (int(common.MavAutopilot.INVALID), 0)

    @property
    def name(self) -> str | None:
        """The name of the current mode, if known."""
        number = self.custom_mode
        if number is not None and number in self.reported:
            return listed_name(*self._kind, number, self.reported[number])
        return None if number is None else mode_name(*self._kind, number)

    @property
    def changed(self) -> bool:
        """True if the vehicle's set of modes changed since it started, so that it has modes of its own."""
        return self._sequence != 0

    def clear_cache(self, now: float) -> None:
        """Discard the state of before a reboot: the mode, and the number of the set of modes."""
        self.custom_mode = self.standard_mode = self.intended = None
        self.reported, self._sequence = {}, 0

    def receive(self, packet: Packet, now: float) -> None:
        if not self.target.covers(Address(packet.system, packet.component)):
            return
        match packet.message:
            case common.Heartbeat() as message if message.autopilot != common.MavAutopilot.INVALID:
                self._kind = int(message.autopilot), int(message.type)
                self._is_in(int(message.custom_mode))
            case common.CurrentMode() as message:
                self.standard_mode = int(message.standard_mode)
                self.intended = int(message.intended_custom_mode)
                self._is_in(int(message.custom_mode))
            case common.AvailableModes(custom_mode=number, mode_name=name):
                if len(self.reported) < MAX_REPORTED:
                    self.reported[int(number)] = name
            case common.AvailableModesMonitor(seq=sequence):
                self._has_set(sequence)

    def _is_in(self, custom_mode: int) -> None:
        if custom_mode != self.custom_mode:
            self.custom_mode = custom_mode
            self.emit(ModeSeen(custom_mode, self.name))

    def _has_set(self, sequence: int) -> None:
        # The first set of modes has the number 0; the number is not sent before the first change.
        if sequence != self._sequence:
            self._sequence = sequence
            self.reported.clear()
            self.emit(ModesOutdated(sequence))
