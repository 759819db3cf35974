"""The route of an action, such as `POST /api/vehicles/1/takeoff`.

An action is answered when it is complete, with `accepted=true` as soon as the vehicle accepted it, or with
`wait=false` at once with the id of a task. A refusal is answered with 409 and the vehicle's status texts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from msgspec import Meta, Struct

from mavstack.http.request_fields import Fields
from mavstack.http.routes import Wait, summary_of
from mavstack.security.roles import Role
from mavstack.server.api_route import ApiRoute, Call
from mavstack.server.request_types import Timeout

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle


class Action(Fields, kw_only=True):
    """An action of a vehicle: its fields are the body of the request, the first line says what it does."""

    timeout: Timeout = None

    async def run(self, vehicle: Vehicle, wait: bool) -> None:
        """Carry it out; with `wait` until it is complete, else until the vehicle accepts it."""
        raise NotImplementedError


class ActionQuery(Wait):
    """The query of an action."""

    accepted: Annotated[
        bool, Meta(description="True: answer as soon as the vehicle accepted the action.")
    ] = False


class ActionAnswer(Struct):
    """The answer to an action that the vehicle carried out, or accepted."""

    system: int
    action: str
    state: Literal["accepted", "done"]


ActionRoute: TypeAlias = ApiRoute[Action, ActionQuery]


def action_route(name: str, action: type[Action], role: Role = Role.OPERATE) -> ActionRoute:
    """Return the route of an action.

    Args:
        name: The end of the path.
        action: The action.
        role: The role that a client needs.

    Returns:
        The route.
    """

    async def handler(call: Call[Action, ActionQuery]) -> ActionAnswer:
        vehicle, accepted = call.vehicle, call.query.accepted
        await call.body.run(vehicle, not accepted)
        return ActionAnswer(vehicle.system, name, "accepted" if accepted else "done")

    return ApiRoute(
        method="POST",
        path=f"/api/vehicles/{{system}}/{name}",
        handler=handler,
        summary=summary_of(action),
        tag="actions",
        role=role,
        body=action,
        query=ActionQuery,
        answer={"system": 1, "action": name, "state": "done"},
        answer_model=ActionAnswer,
    )
