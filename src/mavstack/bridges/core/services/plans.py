"""Services of missions, fences and rally points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.row import Handler, Service
from mavstack.errors import InvalidArgumentError
from mavstack.security.roles import Role
from mavstack.services.mission import MissionItem, Plan, PlanType

if TYPE_CHECKING:
    from mavstack.bridges.core.services.context import ServiceContext
    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.mission import VehiclePlan

Fields = dict[str, Any]
#: The topic with the items of each plan type, which is also the prefix of its services.
LISTS: Final = {
    PlanType.MISSION: "mission/waypoints",
    PlanType.FENCE: "geofence/fences",
    PlanType.RALLY: "rallypoint/rallypoints",
}


def plan_of(vehicle: Vehicle, kind: PlanType) -> VehiclePlan:
    """Return the plan of a type."""
    plans: dict[PlanType, VehiclePlan] = {
        PlanType.MISSION: vehicle.mission,
        PlanType.FENCE: vehicle.fence,
        PlanType.RALLY: vehicle.rally,
    }
    return plans[kind]


async def pull_plan(vehicle: Vehicle, kind: PlanType, context: ServiceContext) -> Plan:
    """Download a plan and publish its list."""
    plan = await plan_of(vehicle, kind).download()
    publish_plan(vehicle, kind, plan, context)
    return plan


def publish_plan(vehicle: Vehicle, kind: PlanType, plan: Plan, context: ServiceContext) -> None:
    """Publish the list of a plan."""
    context.plans[kind] = plan
    progress = vehicle.mission.progress if kind == PlanType.MISSION else None
    current = 0 if progress is None else progress.seq
    context.publish(
        LISTS[kind], (current, tuple(_waypoint(item, i == current) for i, item in enumerate(plan.items)))
    )


def _waypoint(item: MissionItem, current: bool) -> tuple[Any, ...]:
    params = item.param1, item.param2, item.param3, item.param4
    place = item.param5, item.param6, item.param7
    return int(item.frame), int(item.command), current, item.autocontinue, *params, *place


def _item(fields: Fields) -> MissionItem:
    return MissionItem(
        fields["command"],
        fields["param1"],
        fields["param2"],
        fields["param3"],
        fields["param4"],
        fields["x_lat"],
        fields["y_long"],
        fields["z_alt"],
        frame=fields["frame"],
        autocontinue=fields["autocontinue"],
        current=fields["is_current"],
    )


def _pull(kind: PlanType) -> Handler:
    async def handle(vehicle: Vehicle, _request: Fields, context: ServiceContext) -> Fields:
        plan = await pull_plan(vehicle, kind, context)
        return {"success": True, "wp_received": len(plan)}

    return handle


def _push(kind: PlanType) -> Handler:
    async def handle(vehicle: Vehicle, request: Fields, context: ServiceContext) -> Fields:
        start = request["start_index"]
        items = [_item(each) for each in request["waypoints"]]
        sent = len(items)
        if start:
            known = (await plan_of(vehicle, kind).download()).items
            if start > len(known):
                raise InvalidArgumentError(f"start_index must be at most {len(known)}, got {start}")
            items = [*known[:start], *items, *known[start + sent :]]
        plan = await plan_of(vehicle, kind).upload(items)
        publish_plan(vehicle, kind, plan, context)
        return {"success": True, "wp_transfered": sent}

    return handle


def _clear(kind: PlanType) -> Handler:
    async def handle(vehicle: Vehicle, _request: Fields, context: ServiceContext) -> Fields:
        await plan_of(vehicle, kind).clear()
        publish_plan(vehicle, kind, Plan(kind), context)
        return {"success": True}

    return handle


async def set_current(vehicle: Vehicle, request: Fields, _context: ServiceContext) -> Fields:
    """Set the current item (mavros_msgs/WaypointSetCurrent)."""
    await vehicle.mission.set_current(request["wp_seq"])
    return {"success": True}


def _rows(prefix: str, kind: PlanType) -> tuple[Service, ...]:
    package = "mavros_msgs/srv/"
    return (
        Service(f"{prefix}/pull", f"{package}WaypointPull", _pull(kind), Role.OBSERVE, "download"),
        Service(
            f"{prefix}/push",
            f"{package}WaypointPush",
            _push(kind),
            meaning="upload, all or nothing",
            difference="a part replaces these items of the vehicle's plan, which is sent whole",
            required=("waypoints",),
        ),
        Service(f"{prefix}/clear", f"{package}WaypointClear", _clear(kind), meaning="MISSION_CLEAR_ALL"),
    )


ROWS: Final = (
    *_rows("mission", PlanType.MISSION),
    Service(
        "mission/set_current",
        "mavros_msgs/srv/WaypointSetCurrent",
        set_current,
        meaning="DO_SET_MISSION_CURRENT",
        required=("wp_seq",),
    ),
    *_rows("geofence", PlanType.FENCE),
    *_rows("rallypoint", PlanType.RALLY),
)
