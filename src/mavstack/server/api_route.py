"""The routes of the API with their handlers, and the checked request that a handler gets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Generic, TypeAlias, TypeVar

from mavstack.http.bodies import RefusedError
from mavstack.http.routes import BodyT, QueryT, Route
from mavstack.security.roles import Role
from mavstack.server.shared_reads import Key

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from starlette.requests import Request

    from mavstack.server.station import Station
    from mavstack.server.tasks import Task
    from mavstack.vehicle import Vehicle

MAX_SYSTEM: Final = 255
T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class Call(Generic[BodyT, QueryT]):
    """A request that was checked, for its handler.

    Attributes:
        station: The station.
        request: The request; its body was read.
        role: The role of the client.
        session: The session of the client; empty without one.
        query: The fields of the query, or None.
        body: The fields of the JSON body, or None.
        data: The bytes of the body, for routes that take any.
        task: The task that the request runs as; None: the client waits for the answer.
    """

    station: Station
    request: Request
    role: Role
    session: str
    query: QueryT
    body: BodyT
    data: bytes = b""
    task: Task | None = None

    @property
    def progress(self) -> Callable[[int, int], None] | None:
        """The function to which long work reports units done and in total; None: no task follows it."""
        return None if self.task is None else self.task.report

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle whose system id is in the path; raises `RefusedError` if there is none."""
        text = self.path("system")
        if not (text.isascii() and text.isdigit() and 1 <= int(text[:6]) <= MAX_SYSTEM):
            raise RefusedError(404, f"system ids are numbers from 1 to {MAX_SYSTEM}")
        return self.station.vehicle(int(text))

    async def read(self, subject: str, work: Callable[[], Awaitable[T]]) -> T:
        """Return the result of a read of the vehicle, which clients that ask at the same time share.

        Args:
            subject: The subject of the read, such as `mission`.
            work: Reads it.

        Returns:
            The result.
        """
        key = Key(self.vehicle.system, subject)
        return await self.station.reads.read(key, work, observes=self.role is Role.OBSERVE)

    def path(self, name: str) -> str:
        """Return a part of the path by its name."""
        return str(self.request.path_params[name])


#: A request whose body and query have no fields.
PlainCall: TypeAlias = Call[None, None]


@dataclass(frozen=True, slots=True, kw_only=True)
class ApiRoute(Route[BodyT, QueryT]):
    """A route with its handler.

    Attributes:
        handler: Returns the answer: a JSON value, or a response.
        role: The role that a client needs.
        writes: True if it transfers data to a vehicle, for which reads of other clients give way.
    """

    handler: Callable[[Call[BodyT, QueryT]], Awaitable[Any]]
    role: Role = Role.OBSERVE
    writes: bool = False


#: A route with any types of body and query.
AnyRoute: TypeAlias = ApiRoute[Any, Any]
