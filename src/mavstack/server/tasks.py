"""Tasks: requests that run on after their answer, with progress that clients follow.

A request with `?wait=false` is answered at once with 202 and the id of its task. The task keeps its progress
and its result. The number of tasks is bounded: of ended ones the oldest are dropped, and further ones are
refused while too many run.
"""

from __future__ import annotations

import asyncio
import logging
from enum import StrEnum
from itertools import count
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role
from mavstack.server.problems import problem_json

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable
    from typing import TypeAlias

    #: The coroutine function that a task runs; it reports its progress to the task.
    Work: TypeAlias = Callable[["Task"], Awaitable[Any]]

logger = logging.getLogger("mavstack.server")

MAX_RUNNING: Final = 64
#: Number of running tasks from which observing clients cannot start more, so that pilots still can.
MAX_OBSERVED: Final = 32
MAX_ENDED: Final = 32
#: Maximum size of the results of all ended tasks in bytes, such as downloaded logs.
MAX_RESULTS: Final = 256 << 20
#: Minimum seconds between two progress reports to a follower.
REPORT_INTERVAL: Final = 0.1


class TaskState(StrEnum):
    """The state of a task."""

    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


class Task:
    """One task; made by `Tasks.start`."""

    def __init__(self, number: str, name: str, owner: str) -> None:
        self.id = number
        #: The method and path of the request, such as `GET /api/vehicles/1/parameters`.
        self.name = name
        #: The id of the session that started the task; empty without sessions.
        self.owner = owner
        self.state = TaskState.RUNNING
        self.done = 0
        self.total = 0
        #: The current step of the work, as JSON; None if the work has no steps.
        self.step: Any = None
        #: The value of the answer, as for a request without a task.
        self.result: Any = None
        self.error: Exception | None = None
        self._changed = asyncio.Event()
        self._task: asyncio.Task[None] | None = None

    def values(self) -> dict[str, Any]:
        """Return the task as JSON, without its result."""
        found: dict[str, Any] = {
            "task": self.id,
            "name": self.name,
            "state": self.state.value,
            "done": self.done,
            "total": self.total,
        }
        if self.step is not None:
            found["step"] = self.step
        if self.error is not None:
            found |= problem_json(self.error)
        return found

    @property
    def size(self) -> int:
        """The bytes of the result, if it is the answer of a download."""
        return len(getattr(self.result, "body", b""))

    def report(self, done: int, total: int) -> None:
        """Report the progress of the work: units done and in total."""
        self.done, self.total = done, total
        self._changed.set()

    def report_step(self, step: Any) -> None:  # noqa: ANN401 (JSON)
        """Report the step at which the work is, as JSON."""
        self.step = step
        self._changed.set()

    def start(self, work: Work) -> None:
        """Run the work in a task of the event loop."""
        self._task = asyncio.get_running_loop().create_task(self._run(work))

    async def cancel(self) -> None:
        """Cancel the work, and wait for its end."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            if self.state is TaskState.RUNNING:  # the task was cancelled before it began
                self._end(TaskState.CANCELLED)

    async def follow(self) -> AsyncIterator[dict[str, Any]]:
        """Yield the task's values now, after changes, and at its end."""
        while True:
            self._changed.clear()
            yield self.values()
            if self.state is not TaskState.RUNNING:
                return
            await self._changed.wait()
            if self.state is TaskState.RUNNING:
                await asyncio.sleep(REPORT_INTERVAL)

    async def _run(self, work: Work) -> None:
        try:
            self.result = await work(self)
        except asyncio.CancelledError:
            self._end(TaskState.CANCELLED)
            raise
        except Exception as error:
            if not isinstance(error, MavstackError | RefusedError):
                logger.exception("the task %s failed", self.name)
            self.error = error
            self._end(TaskState.FAILED)
        else:
            self._end(TaskState.DONE)

    def _end(self, state: TaskState) -> None:
        self.state = state
        self._changed.set()


class Tasks:
    """The tasks of a station."""

    def __init__(self) -> None:
        self._tasks: dict[str, Task] = {}
        self._numbers = count(1)

    def start(self, name: str, work: Work, owner: str = "", role: Role = Role.ADMINISTER) -> Task:
        """Start a task.

        Args:
            name: The request, for people.
            work: The work, called with the task, to which it reports its progress.
            owner: The session that starts it.
            role: The role of the client.

        Returns:
            The task.

        Raises:
            RefusedError: Too many tasks run.
        """
        running = sum(each.state is TaskState.RUNNING for each in self._tasks.values())
        if running >= (MAX_RUNNING if role > Role.OBSERVE else MAX_OBSERVED):
            raise RefusedError(429, f"{running} tasks run already: wait for one of them, or cancel it")
        self._drop_oldest()
        task = Task(str(next(self._numbers)), name, owner)
        self._tasks[task.id] = task
        task.start(work)
        return task

    def find(self, number: str) -> Task:
        """Return a task by its id; raises `RefusedError` if there is none, or it was dropped."""
        task = self._tasks.get(number)
        if task is None:
            raise RefusedError(404, f"there is no task {number[:20]}")
        return task

    def list(self) -> list[Task]:
        """Return all tasks, oldest first."""
        return list(self._tasks.values())

    async def remove(self, number: str) -> Task:
        """Cancel a task that runs, and drop it with its result."""
        task = self.find(number)
        await task.cancel()
        self._tasks.pop(number, None)
        return task

    def _drop_oldest(self) -> None:
        """Drop the oldest ended tasks while there are too many, or their results are too large."""
        ended = [each for each in self._tasks.values() if each.state is not TaskState.RUNNING]
        size = sum(each.size for each in ended)
        for index, task in enumerate(ended):
            if len(ended) - index < MAX_ENDED and size <= MAX_RESULTS:
                break
            size -= task.size
            del self._tasks[task.id]

    async def close(self) -> None:
        """Cancel all tasks."""
        for task in list(self._tasks.values()):
            await task.cancel()
