"""The conversation of one calibration: commands to the vehicle, steps to the program, waits in between.

A procedure is an async function that holds the conversation and reads from top to bottom. While it waits it
is woken by every packet of the vehicle; it ends in the typed errors of an action (`ActionMonitor`).
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted
from mavstack.services.statustext import StatusText
from mavstack.vehicle.action_monitor import ActionGoal
from mavstack.vehicle.calibration.kinds import CalibrationResult, CalibrationStep, CalibrationTask
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    import asyncio
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.errors import RemoteError
    from mavstack.node.dispatch import Listener
    from mavstack.vehicle.action_monitor import ActionMonitor
    from mavstack.vehicle.calibration.kinds import CalibrationKind, Pose
    from mavstack.vehicle.vehicle import Vehicle

#: The time without a sign of progress after which a calibration fails, in seconds.
STALL_TIMEOUT = 30.0
#: The same time while a person turns the vehicle: PX4 waits this long for each side.
TURN_TIMEOUT = 120.0


class Conversation:
    """The state of a running calibration; procedures use it."""

    def __init__(
        self,
        vehicle: Vehicle,
        kind: CalibrationKind,
        monitor: ActionMonitor,
        steps: asyncio.Queue[CalibrationStep | None],
    ) -> None:
        self.vehicle = vehicle
        self.kind = kind
        #: The latest step of the calibration.
        self.step: CalibrationStep | None = None
        self.result = CalibrationResult(kind)
        #: True once the vehicle has accepted the calibration, until it reports its end.
        self.running = False
        #: Called with each status text of the vehicle.
        self.on_text: Callable[[str], object] = lambda _: None
        #: The reason of the failure that the vehicle reported.
        self.problem: str | None = None
        #: The armed state in which the calibration continues; None: either state.
        self.armed: bool | None = False
        self._monitor = monitor
        self._steps = steps
        self._confirmed = False
        self._signs = 0
        self._texts = vehicle.connection.events(StatusText)
        self._listeners: list[Listener] = []

    # Steps

    def emit_step(
        self,
        task: CalibrationTask,
        text: str,
        *,
        pose: Pose | None = None,
        pending: tuple[Pose, ...] = (),
        progress: int | None = None,
        needs_confirmation: bool = False,
    ) -> None:
        """Pass a step on to the program, unless it is the same as the last one; a new step is progress."""
        step = CalibrationStep(self.kind, task, text, pose, pending, progress, needs_confirmation)
        if step != self.step:
            self._signs += 1
            self.step = step
            self._steps.put_nowait(step)

    async def ask(self, task: CalibrationTask, text: str, *, progress: int | None = None) -> None:
        """Pass on a step that needs a confirmation, and wait for it."""
        self.emit_step(task, text, progress=progress, needs_confirmation=True)
        await self.wait_for_confirmation()

    async def wait_for_confirmation(self) -> None:
        """Wait until the program confirms the step, for ever."""
        self._confirmed = False
        await self.wait(lambda: self._confirmed, inf)

    def confirm(self) -> None:
        """Note the confirmation of the step."""
        self._confirmed = True

    # Communication with the vehicle

    async def command(self, command: int, *params: float, progress: str | None = None) -> None:
        """Send a command; `progress` is the text of the steps that report its progress."""

        def report(done: int, _: int) -> None:
            if progress is not None:
                self.emit_step(CalibrationTask.HOLD_STILL, progress, progress=done)

        request = self.vehicle.component.command(command, *params, progress=report)
        await with_status_texts(self.vehicle, request)
        self.running = True

    async def start(self, *params: float, progress: str | None = None) -> None:
        """Send MAV_CMD_PREFLIGHT_CALIBRATION."""
        await self.command(common.MavCmd.PREFLIGHT_CALIBRATION, *params, progress=progress)

    def listen(self, message: type[Message], callback: Callable[[Message], None]) -> None:
        """Call a function with each message of a class until the calibration ends."""
        self._listeners.append(self.vehicle.add_listener(message, callback))

    async def wait(
        self,
        reached: Callable[[], bool],
        stall_timeout: float = STALL_TIMEOUT,
        *,
        may_be_silent: bool = False,
    ) -> None:
        """Wait until a condition holds, or the vehicle reports a failure.

        Raises:
            ActionInterrupted: The vehicle reported that the calibration failed, or was armed.
            ActionTimeout: The vehicle gave no sign of progress.
            ContactLost: No heartbeat of the vehicle arrives, and `may_be_silent` is not set.
            RemoteCancelled: The connection was closed.
        """

        def ended() -> bool:
            self._read_texts()
            return self.problem is not None or reached()

        goal = ActionGoal(
            ended,
            armed=self.armed,
            stall_timeout=stall_timeout,
            signs=lambda: self._signs,
            may_be_silent=may_be_silent,
        )
        await self._monitor.wait_until_reached(goal)
        if self.problem is not None:
            self.running = False
            raise self.failure(self.problem)

    def failure(self, reason: str) -> RemoteError:
        """Return the error of a calibration that failed."""
        return self._monitor.error(ActionInterrupted, reason)

    def close(self) -> None:
        """Stop listening."""
        for listener in self._listeners:
            listener.close()
        self._texts.close()

    def _read_texts(self) -> None:
        for event in self._texts.drain():
            if event.source == self.vehicle.address:
                self.on_text(event.text)
