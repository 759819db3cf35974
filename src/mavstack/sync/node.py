"""The blocking node and connection, which own the event loop's thread."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from mavstack.node import Node as AsyncNode
from mavstack.node.blocking_portal import BlockingPortal
from mavstack.sync.proxy import Blocking, register
from mavstack.vehicle import Connection as AsyncConnection

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self


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
