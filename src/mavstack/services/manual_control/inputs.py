"""A pilot's input, and the two messages that carry it.

MANUAL_CONTROL has axes from -1000 to 1000, INT16_MAX for a missing axis, and two words of buttons;
`enabled_extensions` tells which of s, t and the six aux axes are valid. It names only a system, in a field
called `target`.

RC_CHANNELS_OVERRIDE has eighteen channels in microseconds of pulse. Two values have another meaning, which
differs between channels:

    channel     0         65534     65535
    1 to 8      release   (pulse)   ignore
    9 to 18     ignore    release   ignore

so that MAVLink 1, and senders that fill only the first eight, do not affect the others.
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

MAX_AXIS: Final = 1000
_INVALID: Final = 0x7FFF
_EXTENSIONS: Final = ("s", "t", "aux1", "aux2", "aux3", "aux4", "aux5", "aux6")
_MAX_BUTTONS: Final = 32

CHANNELS: Final = 18
_FIRST_CHANNELS: Final = 8
#: A channel's value that returns it to the RC receiver.
RELEASE: Final = 0
_IGNORE: Final = 0xFFFF
_RELEASE_HIGH_CHANNEL: Final = 0xFFFE


@dataclass(frozen=True, slots=True)
class ManualInput:
    """Stick positions and buttons.

    Attributes:
        x: Pitch or forward on most vehicles, -1000 to 1000; None if there is no such axis.
        y: Roll or right, likewise.
        z: Thrust or up, likewise.
        r: Yaw, likewise.
        buttons: 32 buttons as bits.
        s: Pitch of vehicles that use x for forward, likewise.
        t: Roll of vehicles that use y for right, likewise.
        aux: Six further axes, likewise.
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
            if value is not None and not -MAX_AXIS <= value <= MAX_AXIS:
                raise InvalidArgumentError(f"an axis must be from -{MAX_AXIS} to {MAX_AXIS}, got {value}")
        if not 0 <= self.buttons < 1 << _MAX_BUTTONS:
            raise InvalidArgumentError(f"buttons must fit into {_MAX_BUTTONS} bits, got {self.buttons}")

    def to_message(self, system: int) -> common.ManualControl:
        """Return the MANUAL_CONTROL."""
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
        """Return the input in a message; values out of range are clamped."""
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
    """Pulses in microseconds by channel, 1 to 18; RELEASE releases a channel; missing ones do not change."""

    channels: Mapping[int, int] = field(default_factory=lambda: MappingProxyType({}))

    def check(self) -> None:
        """Raise InvalidArgumentError if a channel or a pulse is out of range."""
        for channel, value in self.channels.items():
            if not 1 <= channel <= CHANNELS:
                raise InvalidArgumentError(f"a channel must be from 1 to {CHANNELS}, got {channel}")
            if not 0 <= value < _RELEASE_HIGH_CHANNEL:
                raise InvalidArgumentError(
                    f"a pulse must be from 0 to {_RELEASE_HIGH_CHANNEL - 1} us, got {value}"
                )

    def to_message(self, target: Address) -> common.RcChannelsOverride:
        """Return the RC_CHANNELS_OVERRIDE."""
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
        """Return the overridden and released channels of a message."""
        channels: dict[int, int] = {}
        for channel in range(1, CHANNELS + 1):
            value = getattr(message, f"chan{channel}_raw")
            if _releases(channel, value):
                channels[channel] = RELEASE
            elif value not in (0, _IGNORE):
                channels[channel] = value
        return cls(MappingProxyType(channels))

    def released(self) -> ChannelOverride:
        """Return the override that releases all channels of this one."""
        return ChannelOverride(MappingProxyType(dict.fromkeys(self.channels, RELEASE)))


def _wire_value(channel: int, value: int | None) -> int:
    if value is None:
        return _IGNORE
    return _RELEASE_HIGH_CHANNEL if value == RELEASE and channel > _FIRST_CHANNELS else value


def _releases(channel: int, value: int) -> bool:
    return value == (0 if channel <= _FIRST_CHANNELS else _RELEASE_HIGH_CHANNEL)


def _axis(value: int) -> int | None:
    return None if value == _INVALID else max(-MAX_AXIS, min(MAX_AXIS, value))
