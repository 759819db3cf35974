"""A running calibration: an async iterator of its steps, in a block that cancels it if it is left early."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidStateError, MavstackError
from mavstack.node.api_object import ReadOnly
from mavstack.vehicle.action_monitor import ActionMonitor
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.calibration.changed_parameters import ChangedParameters
from mavstack.vehicle.calibration.conversation import Conversation

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.vehicle.calibration.kinds import CalibrationKind, CalibrationResult, CalibrationStep
    from mavstack.vehicle.calibration.procedure import Procedure
    from mavstack.vehicle.vehicle import Vehicle

#: The time in which the vehicle must answer a cancellation, in seconds.
CANCEL_TIMEOUT: Final = 5.0


class CalibrationSession(ReadOnly):
    """A calibration; made by `Calibration.start`.

    Iterating it yields a `CalibrationStep` whenever there is something to do or to show, and ends when the
    calibration is done. A failure raises from the iteration.
    """

    def __init__(
        self, vehicle: Vehicle, kind: CalibrationKind, procedure: Procedure, timeout: float | None
    ) -> None:
        self._vehicle = vehicle
        self._kind = kind
        self._procedure = procedure
        self._timeout = timeout
        self._conversation: Conversation | None = None
        # None: the calibration has ended
        self._steps: asyncio.Queue[CalibrationStep | None] = asyncio.Queue()
        self._task: asyncio.Task[CalibrationResult] | None = None

    @property
    def kind(self) -> CalibrationKind:
        """The kind of the calibration."""
        return self._kind

    @property
    def step(self) -> CalibrationStep | None:
        """The last step; None before the first one."""
        return None if self._conversation is None else self._conversation.step

    @property
    def result(self) -> CalibrationResult | None:
        """The result; None until the calibration is done."""
        task = self._task
        done = task is not None and task.done() and not task.cancelled() and task.exception() is None
        return task.result() if task is not None and done else None

    async def confirm(self) -> None:
        """Confirm that the task of the step is done, such as that the vehicle is in the pose.

        Raises:
            InvalidStateError: The calibration is not waiting for a confirmation.
        """
        step, conversation = self.step, self._conversation
        if conversation is None or step is None or not step.needs_confirmation:
            raise InvalidStateError(f"the {self._kind} calibration does not wait for a confirmation")
        conversation.confirm()

    async def _run(self) -> CalibrationResult:
        operation = f"{self._kind} calibration of"
        try:
            check_preconditions(self._vehicle, "calibration", operation)
            async with ActionMonitor(self._vehicle, operation, self._timeout, rates={}) as monitor:
                return await self._converse(Conversation(self._vehicle, self._kind, monitor, self._steps))
        finally:
            self._steps.put_nowait(None)

    async def _converse(self, conversation: Conversation) -> CalibrationResult:
        self._conversation = conversation
        changed = ChangedParameters(self._vehicle, self._kind)
        try:
            await self._procedure.run(conversation)
            conversation.running = False
            await changed.refresh()
            return conversation.result
        except BaseException:
            await self._cancel(conversation)
            raise
        finally:
            changed.close()
            conversation.close()

    async def _cancel(self, conversation: Conversation) -> None:
        """Tell the vehicle to cancel, unless it has reported the end or cannot be reached."""
        if conversation.running and self._vehicle.connection.is_open and self._vehicle.alive:
            with suppress(MavstackError, TimeoutError):
                async with asyncio.timeout(CANCEL_TIMEOUT):
                    await self._procedure.cancel(self._vehicle)

    async def __aenter__(self) -> Self:
        self._task = asyncio.get_running_loop().create_task(self._run())
        return self

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> CalibrationStep:
        """Return the next step.

        Raises:
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: It was not done within the timeout, or the vehicle gave no sign of progress.
            ActionInterrupted: The vehicle reported that it failed, or was armed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        if self._task is None:
            raise InvalidStateError("start a calibration by `async with`")
        ended = self._task.done() and self._steps.empty()
        if not ended and (step := await self._steps.get()) is not None:
            return step
        await asyncio.wait([self._task])
        self._task.result()  # raises the error if the calibration failed
        raise StopAsyncIteration

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        task = self._task
        if task is not None and not task.done():
            task.cancel()
            await asyncio.wait([task])
        if task is not None and not task.cancelled():
            task.exception()  # marks the error as retrieved: the iteration has raised it, or was ended early
