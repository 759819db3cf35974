"""Functions of the program that carry out commands sent to this node.

    @node.on_command(common.MavCmd.IMAGE_START_CAPTURE)
    def capture(request: CommandRequest) -> common.MavResult: ...

    @node.on_command(common.MavCmd.DO_WINCH)
    async def winch(request: CommandRequest) -> common.MavResult:
        node.commands.progress(request, 40)
        ...

A plain function answers at once. An async one is a long command: its sender hears IN_PROGRESS until it
returns; if the sender cancels the command, its task is cancelled and the answer is CANCELLED; an exception
is told to the loop's handler, and the answer is FAILED.
"""

from __future__ import annotations

import asyncio
from inspect import iscoroutinefunction
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import common
from mavstack.services.command import CommandCancelRequested, CommandServer

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.node.node import Node
    from mavstack.services.command import CommandRequest

AnyHandler = TypeVar("AnyHandler", bound="Callable[..., Any]")


class _Commands(CommandServer):
    """A command server that stops the task of a command that its sender cancels."""

    def __init__(self, handlers: CommandHandlers) -> None:
        super().__init__(handlers.node.address)
        self._handlers_of_node = handlers

    def tell(self, event: Any) -> None:  # noqa: ANN401 (any event)
        super().tell(event)
        if isinstance(event, CommandCancelRequested):
            self._handlers_of_node.cancel(event.request)


class CommandHandlers:
    """The command server of a node, with handlers that may be async."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.server = node.serve(_Commands(self))
        self._tasks: dict[CommandRequest, asyncio.Task[None]] = {}

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
        self.node.changed(self.server)

    def cancel(self, request: CommandRequest) -> None:
        """Stop the task of a long command."""
        task = self._tasks.get(request)
        if task is not None:
            task.cancel()

    def _at_once(self, handler: Callable[..., Any], request: CommandRequest) -> Any:  # noqa: ANN401
        try:
            return handler(request)
        except Exception as error:  # noqa: BLE001 (the sender is owed an answer, the program its trace)
            self._report(request, error)
            return common.MavResult.FAILED

    def _begin(self, handler: Callable[..., Awaitable[Any]], request: CommandRequest) -> None:
        self._tasks[request] = asyncio.get_running_loop().create_task(self._carry_out(handler, request))

    async def _carry_out(self, handler: Callable[..., Awaitable[Any]], request: CommandRequest) -> None:
        outcome: Any = common.MavResult.FAILED
        try:
            outcome = await handler(request)
        except asyncio.CancelledError:
            outcome = common.MavResult.CANCELLED
        except Exception as error:  # noqa: BLE001 (as above)
            self._report(request, error)
        finally:
            del self._tasks[request]
        result, detail = outcome if isinstance(outcome, tuple) else (outcome, 0)
        self.server.complete(request, result, detail)
        self.node.changed(self.server)

    def _report(self, request: CommandRequest, error: Exception) -> None:
        message = f"the handler of {request.command.name} failed"
        asyncio.get_running_loop().call_exception_handler({"message": message, "exception": error})
