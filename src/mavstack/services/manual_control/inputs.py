"""What a pilot's hands do, and the two messages that carry it.

MANUAL_CONTROL has axes from -1000 to 1000, INT16_MAX for an axis that is not there, and two words of buttons;
`enabled_extensions` tells which of s, t and the six aux axes mean anything. It names a system only, in a
field called `target`.

RC_CHANNELS_OVERRIDE has eighteen channels in microseconds of pulse. Two values mean something else, and not
the same for all channels:

    channel     0         65534     65535
    1 to 8      release   (pulse)   leave as it is
    9 to 18     leave     release   leave as it is

so that MAVLink 1, and whoever fills only the first eight, leaves the others alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Self

    from mavstack.services.addressing import Address

FULL: Final = 1000
_INVALID: Final = 0x7FFF
_EXTENSIONS: Final = ("s", "t", "aux1", "aux2", "aux3", "aux4", "aux5", "aux6")
_MAX_BUTTONS: Final = 32

CHANNELS: Final = 18
_FIRST_CHANNELS: Final = 8
#: Given as a channel's value: the radio control has it again.
RELEASE: Final = 0
_IGNORE: Final = 0xFFFF
_RELEASE_LATE: Final = 0xFFFE


@dataclass(frozen=True, slots=True)
class ManualInput:
    """Stick positions from -1000 to 1000, None where there is no stick, and 32 buttons as bits.

    On most vehicles x is pitch or forward, y roll or sideways, z thrust or up, r yaw.
    """

    x: int | None = None
    y: int | None = None
    z: int | None = None
    r: int | None = None
    buttons: int = 0
    s: int | None = None
    t: int | None = None
    aux: tuple[int | None, int | None, int | None, int | None, int | None, int | None] = (None,) * 6

    def check(self) -> None:
        """Raise InvalidArgumentError if an axis or the buttons are out of range."""
        for value in (self.x, self.y, self.z, self.r, self.s, self.t, *self.aux):
            if value is not None and not -FULL <= value <= FULL:
                raise InvalidArgumentError(f"an axis goes from -{FULL} to {FULL}, not to {value}")
        if not 0 <= self.buttons < 1 << _MAX_BUTTONS:
            raise InvalidArgumentError(f"there are {_MAX_BUTTONS} buttons")

    def to_message(self, system: int) -> common.ManualControl:
        """As MANUAL_CONTROL."""
        self.check()
        more = dict(zip(_EXTENSIONS, (self.s, self.t, *self.aux), strict=True))
        enabled = sum(1 << bit for bit, value in enumerate(more.values()) if value is not None)
        x, y, z, r = (_INVALID if value is None else value for value in (self.x, self.y, self.z, self.r))
        return common.ManualControl(
            target=system,
            x=x,
            y=y,
            z=z,
            r=r,
            buttons=self.buttons & 0xFFFF,
            buttons2=self.buttons >> 16,
            enabled_extensions=enabled,
            **{name: value or 0 for name, value in more.items()},
        )

    @classmethod
    def read(cls, message: common.ManualControl) -> Self:
        """The input in a message; an axis beyond its range is at its end."""
        more = [
            _axis(getattr(message, name)) if message.enabled_extensions & 1 << bit else None
            for bit, name in enumerate(_EXTENSIONS)
        ]
        s, t, aux1, aux2, aux3, aux4, aux5, aux6 = more
        return cls(
            _axis(message.x),
            _axis(message.y),
            _axis(message.z),
            _axis(message.r),
            message.buttons | message.buttons2 << 16,
            s,
            t,
            (aux1, aux2, aux3, aux4, aux5, aux6),
        )


@dataclass(frozen=True, slots=True)
class ChannelOverride:
    """Pulses in microseconds by channel, 1 to 18; RELEASE gives one back; the others are left as they are."""

    channels: Mapping[int, int] = field(default_factory=lambda: MappingProxyType({}))

    def check(self) -> None:
        """Raise InvalidArgumentError if a channel or a pulse does not exist."""
        for channel, value in self.channels.items():
            if not 1 <= channel <= CHANNELS:
                raise InvalidArgumentError(f"there is no channel {channel}: they go from 1 to {CHANNELS}")
            if not 0 <= value < _RELEASE_LATE:
                raise InvalidArgumentError(f"{value} is no pulse in microseconds")

    def to_message(self, target: Address) -> common.RcChannelsOverride:
        """As RC_CHANNELS_OVERRIDE."""
        self.check()
        values = {
            f"chan{channel}_raw": _wire_value(channel, self.channels.get(channel))
            for channel in range(1, CHANNELS + 1)
        }
        return common.RcChannelsOverride(
            target_system=target.system, target_component=target.component, **values
        )

    @classmethod
    def read(cls, message: common.RcChannelsOverride) -> Self:
        """What a message overrides and releases."""
        channels: dict[int, int] = {}
        for channel in range(1, CHANNELS + 1):
            value = getattr(message, f"chan{channel}_raw")
            if _releases(channel, value):
                channels[channel] = RELEASE
            elif value not in (0, _IGNORE):
                channels[channel] = value
        return cls(MappingProxyType(channels))

    def released(self) -> ChannelOverride:
        """What gives back all that this overrides."""
        return ChannelOverride(MappingProxyType(dict.fromkeys(self.channels, RELEASE)))


def _wire_value(channel: int, value: int | None) -> int:
    if value is None:
        return _IGNORE
    return _RELEASE_LATE if value == RELEASE and channel > _FIRST_CHANNELS else value


def _releases(channel: int, value: int) -> bool:
    return value == (0 if channel <= _FIRST_CHANNELS else _RELEASE_LATE)


def _axis(value: int) -> int | None:
    return None if value == _INVALID else max(-FULL, min(FULL, value))
