"""The settings of a flight controller: in memory, and in its EEPROM.

Most settings are the content of messages: MSP_PID and MSP_SET_PID have the gains, and the CLI names each of
them. A firmware keeps some messages once for each PID or rate profile. Settings that no message has are
kept by their CLI name.

The EEPROM is a sequence of MSP frames, one for each message that differs from its default, so that it can
be read by any MSP parser, and a damaged part is noticed by its checksum.
"""

from __future__ import annotations

import dataclasses
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, TypeVar

from mavstack.errors import MspDecodeError
from mavstack.msp.frame import Direction, Frame, FrameVersion
from mavstack.msp.messages.navigation import Wp
from mavstack.msp.parser import FrameParser
from mavstack.sim.msp.boxes import ModeRange

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from mavstack.msp.firmware_info import FirmwareInfo
    from mavstack.msp.messages.base import MspMessage

MessageT = TypeVar("MessageT", bound="MspMessage")

#: Number of PID profiles and of rate profiles.
PROFILES: Final = 4
#: Commands of EEPROM frames that hold named settings, the selected profiles, mode ranges and waypoints.
_NAMED, _SELECTED, _RANGE, _WAYPOINT = 0xFF00, 0xFF01, 35, 118


@dataclass(frozen=True, slots=True)
class SettingFacts:
    """All settings of a firmware with their defaults.

    Attributes:
        info: The firmware, on which the layouts of messages depend.
        messages: The default of each message.
        pid_profile: Messages that each PID profile has.
        rate_profile: Messages that each rate profile has.
        named: Defaults of the settings that are in no message, by their CLI names.
        range_count: Number of mode ranges.
        mode_ranges: The first mode ranges of the default.
    """

    info: FirmwareInfo
    messages: Sequence[MspMessage]
    pid_profile: frozenset[type[MspMessage]]
    rate_profile: frozenset[type[MspMessage]]
    named: Mapping[str, int]
    range_count: int
    mode_ranges: Sequence[ModeRange] = ()


class SettingStore:
    """The settings of one controller."""

    def __init__(self, facts: SettingFacts) -> None:
        self.facts = facts
        self.reset()

    def reset(self) -> None:
        """Set all settings to their defaults."""
        facts = self.facts
        self.pid_profile = self.rate_profile = 0
        self._messages: dict[tuple[type[MspMessage], int], MspMessage] = {}
        self.named = dict(facts.named)
        empty = [ModeRange()] * (facts.range_count - len(facts.mode_ranges))
        self.mode_ranges = [*facts.mode_ranges, *empty]
        self._defaults = {type(message): message for message in facts.messages}

    # --- messages

    def __contains__(self, kind: object) -> bool:
        return kind in self._defaults

    def default(self, kind: type[MessageT]) -> MessageT:
        """Return the default of a message."""
        message = self._defaults[kind]
        assert isinstance(message, kind)  # noqa: S101 - the table is keyed by the class
        return message

    def get(self, kind: type[MessageT]) -> MessageT:
        """Return a message with the present settings, of the selected profile."""
        message = self._messages.get((kind, self._profile_of(kind)), self._defaults[kind])
        assert isinstance(message, kind)  # noqa: S101 - the table is keyed by the class
        return message

    def put(self, message: MspMessage) -> None:
        """Keep a message, in the selected profile."""
        self._messages[type(message), self._profile_of(type(message))] = message

    def update(self, kind: type[MspMessage], source: object) -> None:
        """Change a message by the fields that another one has too, except those that are None there."""
        present: Any = self.get(kind)
        changes = {
            field.name: value
            for field in dataclasses.fields(present)
            if (value := getattr(source, field.name, None)) is not None
        }
        self.put(dataclasses.replace(present, **changes))

    def select(self, index: int, *, is_rate_profile: bool) -> None:
        """Select a PID or rate profile; an index that does not exist selects the first one."""
        index = index if index < PROFILES else 0
        if is_rate_profile:
            self.rate_profile = index
        else:
            self.pid_profile = index

    def copy_profile(self, target: int, source: int, *, is_rate_profile: bool) -> None:
        """Copy the messages of a profile to another one; indices that do not exist are ignored."""
        if max(target, source) >= PROFILES:
            return
        kinds = self.facts.rate_profile if is_rate_profile else self.facts.pid_profile
        for kind in kinds:
            self._messages[kind, target] = self._messages.get((kind, source), self._defaults[kind])

    def _profile_of(self, kind: type[MspMessage]) -> int:
        if kind in self.facts.pid_profile:
            return self.pid_profile
        return self.rate_profile if kind in self.facts.rate_profile else 0

    # --- EEPROM

    def encode(self, waypoints: Iterable[Wp] = ()) -> bytes:
        """Return the content of the EEPROM.

        Args:
            waypoints: The saved mission.
        """
        info = self.facts.info
        frames = [_frame(_SELECTED, bytes([self.pid_profile, self.rate_profile]))]
        for (kind, profile), message in self._messages.items():
            frames.append(_frame(kind.COMMAND, message.encode(info), profile))
        for name, value in self.named.items():
            if value != self.facts.named[name]:
                frames.append(_frame(_NAMED, f"{name}={value}".encode()))
        for index, each in enumerate(self.mode_ranges):
            frames.append(_frame(_RANGE, bytes([index, *dataclasses.astuple(each)])))
        frames += [_frame(_WAYPOINT, waypoint.encode()) for waypoint in waypoints]
        return b"".join(frames)

    def decode(self, data: bytes) -> list[Wp]:
        """Set all settings to the content of an EEPROM; what is damaged keeps its default.

        Returns:
            The saved mission.
        """
        self.reset()
        waypoints: list[Wp] = []
        for frame in FrameParser().feed(data):
            with suppress(MspDecodeError, ValueError, IndexError):
                if frame.command == _WAYPOINT:
                    waypoints.append(Wp.decode(frame.payload))
                else:
                    self._load(frame)
        return waypoints

    def _load(self, frame: Frame) -> None:
        payload = frame.payload
        if frame.command == _SELECTED:
            pid_profile, rate_profile = payload
            self.select(pid_profile, is_rate_profile=False)
            self.select(rate_profile, is_rate_profile=True)
        elif frame.command == _NAMED:
            name, _, value = payload.decode().partition("=")
            if name in self.named:
                self.named[name] = int(value)
        elif frame.command == _RANGE:
            index, box, channel, start, end, logic, linked_to = payload
            self.mode_ranges[index] = ModeRange(box, channel, start, end, logic, linked_to)
        else:
            self._load_message(frame)

    def _load_message(self, frame: Frame) -> None:
        for kind in self._defaults:
            if frame.command == kind.COMMAND:
                self._messages[kind, frame.flags] = kind.decode(frame.payload, self.facts.info)


def _frame(command: int, payload: bytes, profile: int = 0) -> bytes:
    return Frame(command, payload, Direction.RESPONSE, FrameVersion.V2, profile).encode()
