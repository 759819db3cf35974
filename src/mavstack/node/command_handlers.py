"""Functions of the program that carry out commands sent to this node.

    @node.on_command(common.MavCmd.IMAGE_START_CAPTURE)
    def capture(request: CommandRequest) -> common.MavResult: ...

    @node.on_command(common.MavCmd.DO_WINCH)
    async def winch(request: CommandRequest) -> common.MavResult:
        node.commands.progress(request, 40)
        ...

A plain function answers at once; if it returns None, it began a long command, and the program ends it by
`node.commands.server.complete`. An async one is a long command: its sender hears IN_PROGRESS until it
returns; if the sender cancels the command, its task is cancelled and the answer is CANCELLED. An exception,
or an outcome that is none, is told to the loop's handler, and the answer is FAILED. Closing the node cancels
the tasks.
"""

from __future__ import annotations

import asyncio
from inspect import iscoroutinefunction
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError
from mavstack.services.command import CommandCancelRequested, CommandServer

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from mavstack.node.node import Node
    from mavstack.services.command import CommandRequest

AnyHandler = TypeVar("AnyHandler", bound="Callable[..., Any]")


class _Commands(CommandServer):
    """A command server that stops the task of a command that its sender cancels."""

    def __init__(self, handlers: CommandHandlers) -> None:
        super().__init__(handlers.node.address)
        self._handlers_of_node = handlers

    def emit(self, event: Any) -> None:  # noqa: ANN401 (any event)
        super().emit(event)
        if isinstance(event, CommandCancelRequested):
            self._handlers_of_node.cancel(event.request)


class CommandHandlers:
    """The command server of a node, with handlers that may be async."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.server = node.serve(_Commands(self))
        self._tasks: dict[CommandRequest, asyncio.Task[Any]] = {}

    def register(self, command: int) -> Callable[[AnyHandler], AnyHandler]:
        """A decorator for the handler of a command."""

        def decorate(handler: AnyHandler) -> AnyHandler:
            if iscoroutinefunction(handler):
                self.server.support(command, lambda request: self._begin(handler, request))
            else:
                self.server.support(command, lambda request: self._at_once(handler, request))
            return handler

        return decorate

    def progress(self, request: CommandRequest, percent: int) -> None:
        """Tell the sender how far a long command is, 0 to 100."""
        self.server.progress(request, percent, self.node.now())
        self.node.wake(self.server)

    def cancel(self, request: CommandRequest) -> None:
        """Stop the task of a long command."""
        task = self._tasks.get(request)
        if task is not None:
            task.cancel()

    async def stop(self) -> None:
        """Stop the tasks of all long commands, and wait until they have ended."""
        tasks = tuple(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    def _at_once(self, handler: Callable[..., Any], request: CommandRequest) -> Any:  # noqa: ANN401
        try:
            outcome = handler(request)
            return None if outcome is None else _checked(outcome)
        except Exception as error:  # noqa: BLE001 (the sender is owed an answer, the program its trace)
            self._report(request, error)
            return common.MavResult.FAILED

    def _begin(self, handler: Callable[..., Coroutine[Any, Any, Any]], request: CommandRequest) -> None:
        self._tasks[request] = task = asyncio.get_running_loop().create_task(handler(request))
        # A task that is cancelled before it began runs nothing of its own; this is called all the same.
        task.add_done_callback(lambda ended: self._ended(request, ended))

    def _ended(self, request: CommandRequest, task: asyncio.Task[Any]) -> None:
        del self._tasks[request]
        result, detail = int(common.MavResult.FAILED), 0
        try:
            result, detail = _checked(task.result())
        except asyncio.CancelledError:
            result = int(common.MavResult.CANCELLED)
        except Exception as error:  # noqa: BLE001 (as above)
            self._report(request, error)
        self.server.complete(request, result, detail)
        self.node.wake(self.server)

    def _report(self, request: CommandRequest, error: Exception) -> None:
        message = f"the handler of {request.command.name} failed"
        asyncio.get_running_loop().call_exception_handler({"message": message, "exception": error})


def _checked(outcome: Any) -> tuple[int, int]:  # noqa: ANN401 (whatever a handler returned)
    """MAV_RESULT and `result_param2`; raises LocalProtocolError if a handler returned neither."""
    result, detail = outcome if isinstance(outcome, tuple) and len(outcome) == 2 else (outcome, 0)
    if type(result) is bool or not isinstance(result, int) or not isinstance(detail, int):
        raise LocalProtocolError(f"a handler returns a MAV_RESULT, or that and a number, not {outcome!r}")
    common.CommandAck(result=result, result_param2=detail)  # raises if a number is out of its range
    return int(result), detail
