"""An operation of several steps, as a generator that yields operations and reads from top to bottom."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.errors import RemoteError
from mavstack.services.operation import Operation

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

Result = TypeVar("Result")


class Procedure(Operation[Result]):
    """An operation of several steps: `steps` yields operations and receives their results or errors."""

    def __init__(
        self, description: str, *, timeout: float | None = None, idle_timeout: float = 600.0
    ) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=idle_timeout)
        self._generator: Generator[Operation[Any], Any, Result] | None = None
        self._now = 0.0

    @abstractmethod
    def steps(self) -> Generator[Operation[Any], Any, Result]:
        """Yield the child operations, as in `answer = yield SomeOperation(…)`, and return the result."""

    @property
    def now(self) -> float:
        """The time of the current step, Unix seconds."""
        return self._now

    def start(self, now: float) -> None:
        self._generator = generator = self.steps()
        self._advance(lambda: next(generator), now)

    def child_ended(self, child: Operation[Any], now: float) -> None:
        generator = self._generator
        if generator is None or self.done:
            return
        self.attempts = max(self.attempts, child.attempts)
        self.report_progress(now)
        error = child.error
        if error is not None:
            self._advance(lambda: generator.throw(error), now)
        else:
            self._advance(lambda: generator.send(child.result()), now)

    def clean_up(self, now: float) -> None:
        if self._generator is not None:
            self._generator.close()

    def _advance(self, step: Callable[[], Operation[Any]], now: float) -> None:
        self._now = now
        try:
            child = step()
        except StopIteration as end:
            self.finish(end.value)
        except RemoteError as error:
            self.fail(error)
        else:
            self.begin(child, now)
