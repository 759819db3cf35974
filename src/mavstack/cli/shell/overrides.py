"""Overrides of RC channels: one stream per vehicle, until the channels are released."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.services.manual_control import RELEASE, ChannelOverride

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.node.control import ControlStream
    from mavstack.vehicle import Vehicle

#: Rate of RC_CHANNELS_OVERRIDE in hertz.
OVERRIDE_RATE: Final = 10.0


class Overrides:
    """The overrides of all vehicles."""

    def __init__(self) -> None:
        self._streams: dict[int, ControlStream[ChannelOverride]] = {}
        self._channels: dict[int, dict[int, int]] = {}

    def active(self, vehicle: Vehicle) -> Mapping[int, int]:
        """Return the overridden channels of a vehicle, in microseconds."""
        return MappingProxyType(dict(sorted(self._channels.get(vehicle.system, {}).items())))

    async def set(self, vehicle: Vehicle, channels: Mapping[int, int]) -> None:
        """Override channels in addition to those already overridden; RELEASE releases a channel."""
        system = vehicle.system
        wanted = {**self._channels.get(system, {}), **channels}
        ChannelOverride(wanted).check()
        held = {channel: pulse for channel, pulse in wanted.items() if pulse != RELEASE}
        if not held:
            await self._end(system)
            return
        if system not in self._streams:
            self._streams[system] = await vehicle.component.override_channels(OVERRIDE_RATE).__aenter__()
        self._channels[system] = held
        self._streams[system].set(ChannelOverride(held))

    async def close(self) -> None:
        """Release all channels."""
        for system in tuple(self._streams):
            await self._end(system)

    async def _end(self, system: int) -> None:
        self._channels.pop(system, None)
        stream = self._streams.pop(system, None)
        if stream is not None:
            await stream.__aexit__(None, None, None)
