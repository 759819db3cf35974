"""The routes of the API: each one holds what its handler needs and what the OpenAPI document says of it."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, TypeAlias, TypeVar

from mavstack.http.bodies import MAX_BODY, RefusedError
from mavstack.security.roles import Role
from mavstack.server.fields import Field
from mavstack.server.shared_reads import Key

if TYPE_CHECKING:
    from starlette.requests import Request

    from mavstack.server.station import Station
    from mavstack.server.tasks import Task
    from mavstack.vehicle import Vehicle

#: The media type of an answer that is the kept one of another route.
ANY_MEDIA_TYPE: Final = "*/*"
MAX_SYSTEM: Final = 255
T = TypeVar("T")
#: The query field of routes whose work may take long.
WAIT: Final = Field(
    name="wait",
    type="boolean",
    about="False: answer at once with 202 and the id of a task.",
    default=True,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """A request that was checked, for its handler.

    Attributes:
        station: The station.
        request: The request; its body was read.
        role: The role of the client.
        session: The session of the client; empty without one.
        query: The values of the query, by name.
        body: The values of the JSON body, by name.
        data: The bytes of the body, for routes that take any.
        task: The task that the request runs as; None: the client waits for the answer.
    """

    station: Station
    request: Request
    role: Role
    session: str = ""
    query: dict[str, Any] = field(default_factory=dict)
    body: dict[str, Any] = field(default_factory=dict)
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
            subject: What is read, such as `mission`.
            work: Reads it.

        Returns:
            The result.
        """
        key = Key(self.vehicle.system, subject)
        return await self.station.reads.read(key, work, observes=self.role is Role.OBSERVE)

    def path(self, name: str) -> str:
        """Return a part of the path by its name."""
        return str(self.request.path_params[name])

    def require(self, role: Role, action: str) -> None:
        """Refuse a client whose role does not allow an action."""
        if self.role < role:
            raise RefusedError(403, f"{action} needs the role {role.word}; yours is {self.role.word}")


Handler: TypeAlias = Callable[[Call], Awaitable[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class ApiRoute:
    """A route.

    Attributes:
        method: The HTTP method.
        path: The path, with names in braces.
        handler: Returns the answer: a JSON value, or a response.
        summary: One line about it.
        tag: The group in the documentation.
        role: The role that a client needs.
        body: The members of the JSON body; None: no body.
        query: The fields of the query.
        takes_bytes: True if the body is not JSON but any bytes, up to `max_body`.
        has_body: False: a request with `takes_bytes` may have no body.
        max_body: The largest body in bytes.
        writes: True if it transfers data to a vehicle, for which reads of other clients give way.
        is_long: True if the work may run on as a task, with `wait=false`.
        status: The status of the answer.
        answer: An example of the answer.
        media_type: The media type of the answer; `ANY_MEDIA_TYPE`: that of another route.
        path_examples: Examples of parts of the path that differ from those of other routes.
    """

    method: str
    path: str
    handler: Handler
    summary: str
    tag: str
    role: Role = Role.OBSERVE
    body: tuple[Field, ...] | None = None
    query: tuple[Field, ...] = ()
    takes_bytes: bool = False
    has_body: bool = True
    max_body: int = MAX_BODY
    writes: bool = False
    is_long: bool = False
    status: int = 200
    answer: Any = None
    media_type: str = "application/json"
    path_examples: Mapping[str, Any] = field(default_factory=dict)

    @property
    def query_fields(self) -> tuple[Field, ...]:
        """All fields of the query."""
        return (*self.query, WAIT) if self.is_long else self.query
