"""The blocking node and connection, which own the event loop's thread."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from mavstack.node import Node as AsyncNode
from mavstack.node.blocking_portal import BlockingPortal
from mavstack.sync.proxy import Blocking, register
from mavstack.vehicle import Connection as AsyncConnection

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

    from mavstack.node.command_handlers import AnyHandler


class Node(Blocking):
    """A node with blocking calls; the arguments are those of `mavstack.Node`."""

    _wrapped: ClassVar[type[AsyncNode]] = AsyncNode

    def __init__(self, *links: Any, **options: Any) -> None:  # noqa: ANN401 (the stub has them all)
        portal = BlockingPortal()
        try:
            super().__init__(portal.call(lambda: self._wrapped(*links, **options)), portal)
        except BaseException:
            portal.close()
            raise

    def open(self) -> Self:
        """Open the links; see `mavstack.Node.open`."""
        self._portal.wait(self._inner.open())
        return self

    def on_command(self, command: int) -> Callable[[AnyHandler], AnyHandler]:
        """Register a function as the handler of a command; in its thread it may make blocking calls."""
        decorator: Callable[[AnyHandler], AnyHandler] = self.commands.register(command)
        return decorator

    def close(self) -> None:
        """Close the links and end the thread. Idempotent."""
        if not self._portal.closed:
            try:
                self._portal.wait(self._inner.close())
            finally:
                self._portal.close()

    def __enter__(self) -> Self:
        try:
            return self.open()
        except BaseException:
            self.close()
            raise

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class Connection(Node):
    """A connection with blocking calls; the arguments are those of `mavstack.connect`."""

    _wrapped = AsyncConnection


register(AsyncNode, Node)
register(AsyncConnection, Connection)


def connect(*links: Any, **options: Any) -> Connection:  # noqa: ANN401 (the stub has them all)
    """Connect to the vehicles on one link or several; a context manager, as `mavstack.connect` is."""
    return Connection(*links, **options)
