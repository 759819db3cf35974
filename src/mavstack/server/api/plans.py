"""The plans of a vehicle: mission, fence and rally points.

A plan is a JSON object of Mavstack's own format, without the home item that ArduPilot keeps first; with
`format` it is the text of another program's file. An upload takes any of the formats. Commands have the names
of the firmware's dialect; one that it does not define has its number.
"""

from __future__ import annotations

import asyncio
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from msgspec import Meta
from starlette.responses import PlainTextResponse

from mavstack.errors import PlanFileError
from mavstack.files.plans import PlanFile, Settings, format_plan, parse_plan, plan_json
from mavstack.files.plans.parsing import MAX_BYTES
from mavstack.http.bodies import RefusedError
from mavstack.http.routes import Wait
from mavstack.security.roles import Role, allows
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.shared_reads import Key
from mavstack.services.mission import PlanType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import Plan
    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.mission import VehiclePlan

KINDS: Final = {"mission": PlanType.MISSION, "fence": PlanType.FENCE, "rally": PlanType.RALLY}
#: Size in bytes from which a file is read in a thread, because it takes long.
LARGE_FILE: Final = 1 << 16
_MISSION_ITEM_INT: Final = 73
_ITEM: Final = {
    "seq": 0,
    "command": 16,
    "name": "NAV_WAYPOINT",
    "frame": 3,
    "params": [0, 0, 0, None, 47.398, 8.546, 30],
    "autocontinue": True,
}


class PlanQuery(Wait):
    """The query of a plan."""

    format: Annotated[
        Literal["json", "plan", "waypoints", "rally", "fence"] | None,
        Meta(description="The format of the answer; null: Mavstack's JSON."),
    ] = None


def _plan_of(vehicle: Vehicle, kind: str) -> VehiclePlan:
    plans: dict[str, VehiclePlan] = {
        "mission": vehicle.mission,
        "fence": vehicle.fence,
        "rally": vehicle.rally,
    }
    return plans[kind]


def _home_first(vehicle: Vehicle) -> bool:
    return vehicle.component.mission.home_first


def _download(kind: str) -> ApiRoute[None, PlanQuery]:
    async def handler(call: Call[None, PlanQuery]) -> Any:  # noqa: ANN401 (JSON, or a response)
        vehicle = call.vehicle
        held = await call.read(kind, lambda: _plan_of(vehicle, kind).download(progress=call.progress))
        plan = _named(vehicle, held)
        info = vehicle.info
        settings = Settings() if info is None else Settings(int(info.autopilot), int(info.type))
        found = PlanFile.of_vehicle([plan], home_first=_home_first(vehicle), settings=settings)
        if call.query.format is None:
            return {**plan_json(found), "id": plan.plan_id}
        return PlainTextResponse(format_plan(found, call.query.format).text)

    example = {"fileType": "MavstackPlan", "version": 1, "home": None, kind: [_ITEM], "id": 3735928559}
    return ApiRoute(
        method="GET",
        path=f"/api/vehicles/{{system}}/{kind}",
        handler=handler,
        summary=f"Download the {_name(kind)}",
        tag="plans",
        query=PlanQuery,
        answer=example,
    )


def _upload(kind: str) -> ApiRoute[None, Wait]:
    async def handler(call: Call[None, Wait]) -> dict[str, Any]:
        vehicle = call.vehicle
        found = await _parse(call.data)
        if found.problems:
            raise PlanFileError(found.problems[0])
        plan = found.for_vehicle(KINDS[kind], home_first=_home_first(vehicle))
        _check_commands(_named(vehicle, plan), call.role)
        held = await _plan_of(vehicle, kind).upload(plan, progress=call.progress)
        call.station.reads.keep(Key(vehicle.system, kind), held)
        return {"system": vehicle.system, "items": len(held), "id": held.plan_id, "notes": list(found.notes)}

    return ApiRoute(
        method="PUT",
        path=f"/api/vehicles/{{system}}/{kind}",
        handler=handler,
        summary=f"Replace the {_name(kind)}",
        tag="plans",
        role=Role.OPERATE,
        writes=True,
        takes_bytes=True,
        max_body=MAX_BYTES,
        query=Wait,
        answer={"system": 1, "items": 4, "id": 3735928559, "notes": []},
    )


def _clear(kind: str) -> ApiRoute[None, None]:
    async def handler(call: PlainCall) -> dict[str, Any]:
        vehicle = call.vehicle
        await _plan_of(vehicle, kind).clear()
        return {"system": vehicle.system, "items": 0}

    return ApiRoute(
        method="DELETE",
        path=f"/api/vehicles/{{system}}/{kind}",
        handler=handler,
        summary=f"Remove the {_name(kind)}",
        tag="plans",
        role=Role.OPERATE,
        writes=True,
        answer={"system": 1, "items": 0},
    )


def _named(vehicle: Vehicle, plan: Plan) -> Plan:
    """Return a plan whose commands have the names of the vehicle's firmware."""
    items = (replace(item, command=vehicle.firmware.named_command(item.command)) for item in plan.items)
    return replace(plan, items=tuple(items))


def _check_commands(plan: Plan, role: Role) -> None:
    """Refuse items with commands that the role may not send, since the vehicle would carry them out later."""
    for item in plan.items:
        if not allows(role, _MISSION_ITEM_INT, int(item.command)):
            raise RefusedError(403, f"the role {role.word} may not upload items with the command {item.name}")


async def _parse(data: bytes) -> PlanFile:
    """Read a plan file; a large one in a thread, so that the vehicles do not wait."""
    return parse_plan(data) if len(data) < LARGE_FILE else await asyncio.to_thread(parse_plan, data)


def _name(kind: str) -> str:
    return "rally points" if kind == "rally" else kind


def _routes() -> Iterator[AnyRoute]:
    for kind in KINDS:
        yield _download(kind)
        yield _upload(kind)
        yield _clear(kind)


ROUTES: Final[tuple[AnyRoute, ...]] = tuple(_routes())
