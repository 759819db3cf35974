"""The route of an action, such as `POST /api/vehicles/1/takeoff`.

An action is answered when it is complete, with `accepted=true` as soon as the vehicle accepted it, or with
`wait=false` at once with the id of a task. A refusal is answered with 409 and the vehicle's status texts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.security.roles import Role
from mavstack.server.api_route import ApiRoute, Call
from mavstack.server.fields import Field

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from typing import TypeAlias

    from mavstack.vehicle import Vehicle

    #: Called with the vehicle, the values of the body, and whether to wait until the action is complete.
    Action: TypeAlias = Callable[[Vehicle, dict[str, Any], bool], Awaitable[Any]]

TIMEOUT: Final = Field(name="timeout", about="Seconds for the whole action; null: no limit.", minimum=0)
_ACCEPTED: Final = Field(
    name="accepted",
    type="boolean",
    about="True: answer as soon as the vehicle accepted the action.",
    default=False,
)


def action_route(
    name: str, action: Action, summary: str, fields: tuple[Field, ...], role: Role = Role.OPERATE
) -> ApiRoute:
    """Return the route of an action.

    Args:
        name: The end of the path.
        action: The action.
        summary: One line about it.
        fields: The fields of the body; `timeout` is added.
        role: The role that a client needs.

    Returns:
        The route.
    """

    async def handler(call: Call) -> dict[str, Any]:
        vehicle, accepted = call.vehicle, call.query["accepted"]
        await action(vehicle, call.body, not accepted)
        return {"system": vehicle.system, "action": name, "state": "accepted" if accepted else "done"}

    return ApiRoute(
        method="POST",
        path=f"/api/vehicles/{{system}}/{name}",
        handler=handler,
        summary=summary,
        tag="actions",
        role=role,
        body=(*fields, TIMEOUT),
        query=(_ACCEPTED,),
        is_long=True,
        answer={"system": 1, "action": name, "state": "done"},
    )
