"""The flight modes of a remote component: `component.modes`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import CommandDenied, InvalidTypeError
from mavstack.node.api_object import ReadOnly
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.services.modes import (
    ListModes,
    ModeMonitor,
    ModeSeen,
    SetMode,
    SetStandardMode,
    listed_name,
    mode_names,
    modes_of,
)

if TYPE_CHECKING:
    from mavstack.node.clients import ComponentClients
    from mavstack.node.subscription import Subscription
    from mavstack.services.modes import AvailableMode


class Modes(ReadOnly):
    """The flight modes of a remote component, by names that do not depend on the firmware's numbers."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients

    @property
    def _client(self) -> ModeMonitor:
        return self._clients.get(ModeMonitor)

    def follow(self) -> None:
        """Start to follow the mode, so that `current` is known; every other method does this too."""
        _ = self._client

    @property
    def current(self) -> str | None:
        """The name of the current mode; None until a heartbeat was received."""
        return self._client.name

    async def set(self, mode: str | int, *, timeout: float | None = None) -> int:
        """Set the flight mode (MAV_CMD_DO_SET_MODE), and wait until a heartbeat confirms it.

        Args:
            mode: The name of the mode, such as "GUIDED", or its custom mode number.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The custom mode number that was set.

        Raises:
            InvalidTypeError: The mode is neither a name nor a number.
            CommandDenied: The component refused the mode.
            CommandTimeout: The component does not answer.
            ModeTimeout: The mode was accepted and not entered, or no heartbeat is received.
        """
        if not isinstance(mode, str | int):
            raise InvalidTypeError(f"mode must be a name or a number, got {mode!r}")
        monitor = self._client
        operation = SetMode(mode, reported=monitor.reported, changed=monitor.changed, timeout=timeout)
        return await self._clients.host.run_operation(self._clients.command, operation)

    async def set_standard(self, standard_mode: int, *, timeout: float | None = None) -> int:
        """Set a standard mode (MAV_CMD_DO_SET_STANDARD_MODE), whose meaning does not depend on the firmware.

        Args:
            standard_mode: A MAV_STANDARD_MODE.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The custom mode number that was set.

        Raises:
            CommandDenied: The component refused the mode, or does not know standard modes.
            CommandTimeout: The component does not answer.
            ModeTimeout: The mode was accepted and not entered, or no heartbeat is received.
        """
        operation = SetStandardMode(standard_mode, timeout=timeout)
        return await self._clients.host.run_operation(self._clients.command, operation)

    async def list(self, *, timeout: float | None = None) -> tuple[AvailableMode, ...]:
        """List the modes of the component (AVAILABLE_MODES).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The modes that the component reports, with the names that `current` and `set` use; of a firmware
            that does not report them, the documented ones.

        Raises:
            CommandDenied: The component does not report its modes, and its firmware is not known.
            CommandTimeout: The component does not answer.
        """
        known = self._documented_modes()
        try:
            listed = await self._clients.host.run_operation(self._clients.command, ListModes(timeout=timeout))
        except CommandDenied:
            if not known:
                raise
            return known
        info = self._clients.info
        kind = (info.autopilot, info.type) if info is not None else (common.MavAutopilot.INVALID, 0)
        return tuple(replace(mode, name=listed_name(*kind, mode.custom_mode, mode.name)) for mode in listed)

    def changes(self) -> Subscription[ModeSeen]:
        """Subscribe to changes of the mode."""
        return self._clients.host.events(ModeSeen, of=self._client, queue=DEFAULT_QUEUE)

    def _documented_modes(self) -> tuple[AvailableMode, ...]:
        info = self._clients.info
        if info is None:
            return ()
        return tuple(modes_of(info.autopilot, info.type, list(mode_names(info.autopilot, info.type))))
