"""The flight modes of a flight controller by the standard modes protocol; see `boxes` for their numbers."""

from __future__ import annotations

import asyncio
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.bridges.msp.boxes import ACRO
from mavstack.dialects import common
from mavstack.services.modes import ModeServer

if TYPE_CHECKING:
    from mavstack.bridges.msp.controller_facts import ControllerFacts
    from mavstack.bridges.msp.pilot import Pilot
    from mavstack.bridges.msp.status import ControllerStatus
    from mavstack.node import Node
    from mavstack.services import Address
    from mavstack.services.command import CommandRequest
    from mavstack.services.modes import AvailableMode

_CMD: Final = common.MavCmd
_RESULT: Final = common.MavResult
_CUSTOM: Final = common.MavModeFlag.CUSTOM_MODE_ENABLED


class BridgedModes:
    """The modes of one bridge.

    Args:
        node: The node of the bridge.
        pilot: Moves the switches.
        facts: The facts of the flight controller.
    """

    def __init__(self, node: Node, pilot: Pilot, facts: ControllerFacts) -> None:
        self._node, self._pilot, self._facts = node, pilot, facts
        self._tasks: set[asyncio.Task[None]] = set()
        modes = facts.boxes.modes()
        self.server = ModeServer(node.address, modes, ACRO, may_enter=self._enter_later)
        self.server.register(node.commands.server)
        node.serve(self.server)
        node.on_command(_CMD.DO_SET_MODE)(self._set_mode)
        node.on_command(_CMD.DO_SET_STANDARD_MODE)(self._set_standard_mode)

    def set_facts(self, facts: ControllerFacts, now: float) -> None:
        """Take new facts after a restart, and offer the modes if they changed."""
        changed = tuple(facts.boxes.modes()) != self.server.modes
        self._facts = facts
        if changed:
            self.server.offer(facts.boxes.modes(), now)
            self._node.wake(self.server)

    def update(self, status: ControllerStatus) -> AvailableMode:
        """Take a status; returns the current mode."""
        custom_mode = self._facts.boxes.custom_mode(status.active)
        if custom_mode != self.server.current.custom_mode:
            self.server.enter(custom_mode, self._node.now())
            self._node.wake(self.server)
            self._node.send(self.current_message())
        return self.server.current

    def announce(self) -> None:
        """Send the names of all modes, which clients cannot know for a generic autopilot."""
        modes = self.server.modes
        for index, mode in enumerate(modes, 1):
            self._node.send(mode.to_message(index, len(modes)))

    def current_message(self) -> common.AvailableModes:
        """Return AVAILABLE_MODES of the current mode."""
        modes = self.server.modes
        index = modes.index(self.server.current) if self.server.current in modes else 0
        return modes[index].to_message(index + 1, len(modes))

    async def _set_mode(self, request: CommandRequest) -> common.MavResult:
        flags, wanted = request.command.param1, request.command.param2
        if not (isfinite(flags) and isfinite(wanted) and int(flags) & _CUSTOM):
            return self._refuse(request.source, "only custom modes can be set")
        return await self._enter(request.source, int(wanted))

    async def _set_standard_mode(self, request: CommandRequest) -> common.MavResult:
        wanted = request.command.param1
        found = [mode for mode in self.server.modes if wanted and mode.standard_mode == wanted]
        if not found:
            return self._refuse(request.source, f"there is no standard mode {wanted:g}")
        return await self._enter(request.source, found[0].custom_mode)

    async def _enter(self, source: Address, custom_mode: int) -> common.MavResult:
        mode = next((mode for mode in self.server.modes if mode.custom_mode == custom_mode), None)
        if mode is None or not mode.selectable:
            return self._refuse(source, f"there is no mode {custom_mode}")
        reason = await self._pilot.set_mode(source, custom_mode)
        if reason is not None:
            return self._refuse(source, reason)
        self.server.enter(custom_mode, self._node.now(), commanded=True)
        self._node.wake(self.server)
        return _RESULT.ACCEPTED

    def _enter_later(self, mode: AvailableMode, source: Address) -> str | None:
        """Change the mode for the older SET_MODE, which is not acknowledged; the status shows the result."""

        async def enter() -> None:
            await self._enter(source, mode.custom_mode)

        task = asyncio.get_running_loop().create_task(enter())
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return None

    def _refuse(self, source: Address, reason: str) -> common.MavResult:
        text = f"Mode refused: {reason}"
        self._node.send(common.Statustext(severity=common.MavSeverity.WARNING, text=text[:50]), source)
        return _RESULT.FAILED
