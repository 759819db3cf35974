"""The flight modes of a vehicle, by name, whatever its firmware calls them on the wire."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.errors import CommandDenied
from mavstack.services.modes import (
    ListModes,
    ModeMonitor,
    ModeSeen,
    SetMode,
    SetStandardMode,
    mode_names,
    modes_of,
)

if TYPE_CHECKING:
    from mavstack.node.component import RemoteComponent
    from mavstack.node.subscription import Subscription
    from mavstack.services.modes import AvailableMode


class Modes:
    """The modes of one vehicle; raises `CommandDenied`, or `ModeTimeout` if a mode is not entered."""

    def __init__(self, remote: RemoteComponent) -> None:
        self._remote = remote

    @cached_property
    def monitor(self) -> ModeMonitor:
        """Follows the mode from the first use on."""
        return self._remote.node.serve(ModeMonitor(self._remote.node.address, self._remote.address))

    @property
    def current(self) -> str | None:
        """The name of the mode that it is in, as far as was heard."""
        return self.monitor.name

    async def set(self, mode: str | int, *, timeout: float = 60.0) -> int:
        """Enter a mode, by its name or custom mode number, and see that it is entered."""
        return await self._remote.node.run_operation(self._remote.command_client, SetMode(mode, timeout=timeout))

    async def set_standard(self, standard_mode: int, *, timeout: float = 60.0) -> int:
        """Enter a MAV_STANDARD_MODE, which means the same on every vehicle that has it."""
        operation = SetStandardMode(standard_mode, timeout=timeout)
        return await self._remote.node.run_operation(self._remote.command_client, operation)

    async def list(self, *, timeout: float = 60.0) -> tuple[AvailableMode, ...]:
        """The modes that it says it has; of a firmware that does not tell, those that are known of it."""
        known = self._known_modes()
        try:
            told = await self._remote.node.run_operation(self._remote.command_client, ListModes(timeout=timeout))
        except CommandDenied:
            if not known:
                raise
            return known
        # A standard mode has no name on the wire; it is one of the firmware's own all the same.
        names = {mode.custom_mode: mode.name for mode in known}
        return tuple(
            mode if mode.name else replace(mode, name=names.get(mode.custom_mode, "")) for mode in told
        )

    def clear_cache(self) -> None:
        """The vehicle started anew: it may be in another mode, and have others."""
        if "monitor" in self.__dict__:
            self.monitor.forget()

    def _known_modes(self) -> tuple[AvailableMode, ...]:
        info = self._remote.info
        if info is None:
            return ()
        return tuple(modes_of(info.autopilot, info.type, list(mode_names(info.autopilot, info.type))))

    def changes(self) -> Subscription[ModeSeen]:
        """Each mode that is entered from now on."""
        return self._remote.node.events(ModeSeen, of=self.monitor)
