"""Handlers: functions of the program that execute commands sent to the node.

    @node.on_command(common.MavCmd.IMAGE_START_CAPTURE)
    def capture(request: CommandRequest) -> common.MavResult: ...

    @node.on_command(common.MavCmd.DO_WINCH)
    async def winch(request: CommandRequest) -> common.MavResult:
        node.commands.progress(request, 40)
        ...

The result of a plain function is sent immediately. A function that returns None started a long command, which
the program ends by `node.commands.server.complete`. An async function is a long command: its sender receives
IN_PROGRESS until it returns; if the sender cancels the command, or a disarming ends an arming, the task is
cancelled and the answer is CANCELLED. An exception, or a return value that is no result, is reported to the
event loop's exception handler, and the answer is FAILED. Closing the node cancels the tasks.
"""

from __future__ import annotations

import asyncio
from inspect import iscoroutinefunction
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import common
from mavstack.errors import InvalidTypeError
from mavstack.node.api_object import ReadOnly
from mavstack.services.command import CommandCancelRequested, CommandServer

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from mavstack.node.host import NodeHost
    from mavstack.services import Address
    from mavstack.services.command import CommandRequest

AnyHandler = TypeVar("AnyHandler", bound="Callable[..., Any]")


class _Server(CommandServer):
    """A command server that reports each cancellation by a sender to a function."""

    def __init__(self, local: Address, on_cancel: Callable[[CommandRequest], None]) -> None:
        super().__init__(local)
        self._on_cancel = on_cancel

    def emit(self, event: Any) -> None:  # noqa: ANN401 (any event)
        super().emit(event)
        if isinstance(event, CommandCancelRequested):
            self._on_cancel(event.request)


class CommandHandlers(ReadOnly):
    """The command server of a node, with plain and async handlers."""

    server: CommandServer

    def __init__(self, host: NodeHost) -> None:
        self._host = host
        #: The server of the command protocol.
        self.server: CommandServer = host.serve(_Server(host.address, self._cancel))
        self._tasks: dict[CommandRequest, asyncio.Task[Any]] = {}

    def register(self, command: int) -> Callable[[AnyHandler], AnyHandler]:
        """Register a function as the handler of a command.

        Args:
            command: The MAV_CMD.

        Returns:
            A decorator for the function, plain or async. It gets a `CommandRequest` and returns a MAV_RESULT,
            or a tuple of a MAV_RESULT and the `result_param2` of COMMAND_ACK.
        """

        def decorate(handler: AnyHandler) -> AnyHandler:
            if iscoroutinefunction(handler):
                self._run_as_task(command, handler)
            else:
                self.server.support(command, lambda request: self._call(handler, request))
            return handler

        return decorate

    def _run_as_task(
        self, command: int, handler: Callable[..., Coroutine[Any, Any, Any]], *, none_is_pending: bool = False
    ) -> None:
        """Register an async function as the handler of a command.

        Args:
            command: The MAV_CMD.
            handler: The function; `register` describes its argument and its result.
            none_is_pending: True if a handler that returns None leaves the command running, until the program
                ends it by `server.complete`; otherwise None is an error.
        """
        self.server.support(command, lambda request: self._start(handler, request, none_is_pending))

    def progress(self, request: CommandRequest, percent: int) -> None:
        """Report the progress of a long command to its sender.

        Args:
            request: The request that the handler got.
            percent: 0 to 100.
        """
        self.server.progress(request, percent, self._host.now())
        self._host.wake(self.server)

    async def stop(self) -> None:
        """Cancel the tasks of all long commands, and wait until they have ended.

        A handler may close its own node: its task is not cancelled.
        """
        tasks = [task for task in self._tasks.values() if task is not asyncio.current_task()]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    def _cancel(self, request: CommandRequest) -> None:
        task = self._tasks.get(request)
        if task is not None:
            task.cancel()

    def _call(self, handler: Callable[..., Any], request: CommandRequest) -> Any:  # noqa: ANN401
        try:
            outcome = handler(request)
            return None if outcome is None else _checked(outcome)
        except Exception as error:  # noqa: BLE001 (the sender needs an answer, the program its traceback)
            self._report(request, error)
            return common.MavResult.FAILED

    def _start(
        self,
        handler: Callable[..., Coroutine[Any, Any, Any]],
        request: CommandRequest,
        none_is_pending: bool,
    ) -> None:
        self._tasks[request] = task = asyncio.get_running_loop().create_task(handler(request))
        # Not `finally` in the task: a task that is cancelled before its first step does not execute it.
        task.add_done_callback(lambda ended: self._on_task_ended(request, ended, none_is_pending))

    def _on_task_ended(
        self,
        request: CommandRequest,
        task: asyncio.Task[Any],
        none_is_pending: bool,
    ) -> None:
        del self._tasks[request]
        result, detail = int(common.MavResult.FAILED), 0
        try:
            outcome = task.result()
            if outcome is None and none_is_pending:
                return
            result, detail = _checked(outcome)
        except asyncio.CancelledError:
            result = int(common.MavResult.CANCELLED)
        except Exception as error:  # noqa: BLE001 (as above)
            self._report(request, error)
        self.server.complete(request, result, detail)
        self._host.wake(self.server)

    def _report(self, request: CommandRequest, error: Exception) -> None:
        message = f"the handler of {request.command.name} failed"
        asyncio.get_running_loop().call_exception_handler({"message": message, "exception": error})


def _checked(outcome: Any) -> tuple[int, int]:  # noqa: ANN401 (the value that a handler returned)
    """Return MAV_RESULT and `result_param2`; raise InvalidTypeError if a handler returned neither."""
    result, detail = outcome if isinstance(outcome, tuple) and len(outcome) == 2 else (outcome, 0)
    if type(result) is bool or not isinstance(result, int) or not isinstance(detail, int):
        raise InvalidTypeError(f"a handler must return a MAV_RESULT, or that and a number, not {outcome!r}")
    common.CommandAck(result=result, result_param2=detail)  # raises if a number is out of its range
    return int(result), detail
