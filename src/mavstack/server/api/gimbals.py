"""The gimbals of a vehicle: ranges, control, attitude, pointing.

A gimbal manager obeys the component in control: the station, for all its clients. A request that moves
a gimbal takes control first; `force` takes it from another component.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated, Any, Final

from msgspec import Meta

from mavstack.errors import CommandDenied, MavstackError
from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait, summary_of
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.json_values import to_json
from mavstack.server.request_types import Degrees90, Degrees180, Latitude, Longitude, Timeout

if TYPE_CHECKING:
    from mavstack.node.gimbal import Gimbal
    from mavstack.vehicle import Vehicle

_GIMBALS: Final = "/api/vehicles/{system}/gimbals"
_GIMBAL: Final = f"{_GIMBALS}/{{gimbal}}"
#: The id of a gimbal: its device id, preceded by the component id of a manager other than the autopilot.
_ID: Final = re.compile(r"(?:(\d{1,3})-)?(\d{1,3})")
MAX_ID: Final = 255
Rate = Annotated[float | None, Meta(description="Degrees per second; null: the gimbal's own.")]


def gimbal_json(vehicle: Vehicle, gimbal: Gimbal) -> dict[str, Any]:
    """Return a gimbal as JSON, as far as it is known."""
    manager, status = gimbal.address.component, gimbal.status
    prefix = "" if manager == vehicle.address.component else f"{manager}-"
    owners = () if status is None else (status.primary, status.secondary)
    return {
        "id": f"{prefix}{gimbal.device_id}",
        "manager": manager,
        "device": gimbal.device_id,
        "information": to_json(gimbal.information),
        "controlled_by": [str(owner) for owner in owners if owner is not None],
        "in_control": status is not None and status.is_controlled_by(vehicle.connection.address),
        "attitude": to_json(gimbal.attitude),
    }


_EXAMPLE: Final = {
    "id": "1",
    "manager": 1,
    "device": 1,
    "information": {"vendor": "Mavstack", "pitch_range": [-90.0, 30.0], "yaw_range": [-180.0, 180.0]},
    "controlled_by": ["255/190"],
    "in_control": True,
    "attitude": {"pitch": -45.0, "yaw": 0.0, "heading": 90.0},
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "gimbals")


@ROUTES.add("GET", _GIMBALS, "List the gimbals of a vehicle: ranges, control and attitude", answer=[_EXAMPLE])
async def _list(call: Call[None, Wait]) -> list[dict[str, Any]]:
    vehicle = call.vehicle
    found = await call.read("gimbals", lambda: _find(vehicle))
    return [gimbal_json(vehicle, gimbal) for gimbal in found]


async def _find(vehicle: Vehicle) -> tuple[Gimbal, ...]:
    gimbals = await vehicle.find_gimbals()
    for gimbal in gimbals:
        try:
            await gimbal.get_status()
        except MavstackError:
            continue  # a manager without control does not report a status
    return gimbals


@ROUTES.add(
    "GET", _GIMBAL, "Show a gimbal as far as it is known, without asking the vehicle", answer=_EXAMPLE
)
async def _show(call: PlainCall) -> dict[str, Any]:
    return gimbal_json(call.vehicle, _gimbal(call))


class GimbalAction(Fields, kw_only=True):
    """An action of a gimbal: its fields are the body of the request."""

    force: Annotated[bool, Meta(description="Take control from another component.")] = False
    timeout: Timeout = None

    async def run(self, gimbal: Gimbal, wait: bool) -> None:
        """Carry it out; with `wait` until the gimbal is there."""
        raise NotImplementedError

    async def take(self, gimbal: Gimbal) -> None:
        """Take control, which a manager without it refuses: it obeys all components."""
        try:
            await gimbal.take_control(force=self.force, timeout=self.timeout)
        except CommandDenied:
            return


class PointGimbal(GimbalAction):
    """Point a gimbal."""

    pitch: Annotated[
        Degrees90 | None, Meta(description="Degrees above the horizon; null leaves it.", examples=[-45])
    ] = None
    yaw: Annotated[
        Degrees180 | None,
        Meta(description="Degrees to the right of the nose, or of north with `yaw_lock`; null leaves it."),
    ] = None
    pitch_rate: Rate = None
    yaw_rate: Rate = None
    yaw_lock: Annotated[bool, Meta(description="Keep the direction when the vehicle turns.")] = False

    async def run(self, gimbal: Gimbal, wait: bool) -> None:  # noqa: D102
        rates = {"pitch_rate": self.pitch_rate, "yaw_rate": self.yaw_rate}
        options = {"yaw_lock": self.yaw_lock, "timeout": self.timeout}
        await self.take(gimbal)
        await gimbal.point(self.pitch, self.yaw, wait=wait, **rates, **options)  # type: ignore[arg-type]


class TurnGimbal(GimbalAction):
    """Turn a gimbal at constant rates; 0 stops it."""

    pitch_rate: Annotated[float, Meta(description="Degrees per second, positive up.")] = 0.0
    yaw_rate: Annotated[float, Meta(description="Degrees per second, positive to the right.")] = 0.0
    yaw_lock: Annotated[bool, Meta(description="Keep the direction when the vehicle turns.")] = False

    async def run(self, gimbal: Gimbal, wait: bool) -> None:  # noqa: D102
        await self.take(gimbal)
        await gimbal.turn(self.pitch_rate, self.yaw_rate, yaw_lock=self.yaw_lock, timeout=self.timeout)


class CenterGimbal(GimbalAction):
    """Point a gimbal to its neutral position."""

    async def run(self, gimbal: Gimbal, wait: bool) -> None:  # noqa: D102
        await self.take(gimbal)
        await gimbal.center(wait=wait, timeout=self.timeout)


class RetractGimbal(GimbalAction):
    """Retract a gimbal to its safe position."""

    async def run(self, gimbal: Gimbal, wait: bool) -> None:  # noqa: D102
        await self.take(gimbal)
        await gimbal.retract(wait=wait, timeout=self.timeout)


class TakeGimbal(GimbalAction):
    """Take control of a gimbal."""

    secondary: Annotated[bool, Meta(description="Take secondary control.")] = False

    async def run(self, gimbal: Gimbal, wait: bool) -> None:  # noqa: D102
        options = {"force": self.force, "timeout": self.timeout}
        await gimbal.take_control(secondary=self.secondary, **options)  # type: ignore[arg-type]


class ReleaseGimbal(GimbalAction):
    """Give up control of a gimbal."""

    async def run(self, gimbal: Gimbal, wait: bool) -> None:  # noqa: D102
        await gimbal.release_control(timeout=self.timeout)


class KeepInView(GimbalAction):
    """Keep a place in view of a gimbal."""

    latitude: Latitude
    longitude: Longitude
    altitude: Annotated[float, Meta(description="Metres above home.")] = 0.0

    async def run(self, gimbal: Gimbal, wait: bool) -> None:  # noqa: D102
        await self.take(gimbal)
        await gimbal.set_roi(self.latitude, self.longitude, self.altitude, timeout=self.timeout)


class KeepVehicleInView(GimbalAction):
    """Keep another vehicle in view of a gimbal."""

    target: Annotated[int, Meta(description="The system id of that vehicle.", ge=1, le=MAX_ID, examples=[2])]

    async def run(self, gimbal: Gimbal, wait: bool) -> None:  # noqa: D102
        await self.take(gimbal)
        await gimbal.set_roi_system(self.target, timeout=self.timeout)


class KeepNothingInView(GimbalAction):
    """Keep nothing in view of a gimbal any more."""

    async def run(self, gimbal: Gimbal, wait: bool) -> None:  # noqa: D102
        await gimbal.clear_roi(timeout=self.timeout)


class GimbalQuery(Wait):
    """The query of an action of a gimbal."""

    accepted: Annotated[bool, Meta(description="True: answer as soon as the gimbal accepted the action.")] = (
        False
    )


def _gimbal(call: Call[Any, Any]) -> Gimbal:
    found, vehicle = _ID.fullmatch(call.path("gimbal")), call.vehicle
    manager, device = (int(found[1] or vehicle.address.component), int(found[2])) if found else (0, 0)
    if found is None or not (1 <= manager <= MAX_ID and device <= MAX_ID):
        raise RefusedError(404, "ids of gimbals are numbers, such as 1, or 154-1 for one of component 154")
    component = vehicle.connection.component(vehicle.system, manager)
    return component.gimbal_device(device) if device else component.gimbal


def _route(name: str, action: type[GimbalAction]) -> ApiRoute[GimbalAction, GimbalQuery]:
    async def handler(call: Call[GimbalAction, GimbalQuery]) -> dict[str, Any]:
        gimbal = _gimbal(call)
        await call.body.run(gimbal, not call.query.accepted)
        return gimbal_json(call.vehicle, gimbal)

    return ApiRoute(
        method="POST",
        path=f"{_GIMBAL}/{name}",
        handler=handler,
        summary=summary_of(action),
        tag="gimbals",
        role=Role.OPERATE,
        body=action,
        query=GimbalQuery,
        answer=_EXAMPLE,
    )


#: The action at the end of each path.
ACTIONS: Final[dict[str, type[GimbalAction]]] = {
    "point": PointGimbal,
    "turn": TurnGimbal,
    "center": CenterGimbal,
    "retract": RetractGimbal,
    "control": TakeGimbal,
    "control/release": ReleaseGimbal,
    "roi": KeepInView,
    "roi/vehicle": KeepVehicleInView,
    "roi/clear": KeepNothingInView,
}

ROUTES.extend((_route(name, action) for name, action in ACTIONS.items()))
