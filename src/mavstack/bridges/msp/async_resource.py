"""The context manager of what is opened and closed by coroutines."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from types import TracebackType


class AsyncResource(ABC):
    """An async context manager: opened at the start of the block, closed at its end."""

    @abstractmethod
    async def open(self) -> Self:
        """Open the resource."""

    @abstractmethod
    async def close(self) -> None:
        """Close the resource. Idempotent, and possible when it is not open."""

    async def __aenter__(self) -> Self:
        try:
            return await self.open()
        except BaseException:
            await self.close()
            raise

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
