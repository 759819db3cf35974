"""The vehicles: who they are, what they can do, and the telemetry that they send."""

from __future__ import annotations

from dataclasses import asdict, fields, is_dataclass
from typing import TYPE_CHECKING, Any, Final

from mavstack.http.routes import RouteTable
from mavstack.server.api_route import AnyRoute, ApiRoute, PlainCall
from mavstack.server.conflict_json import conflict_json
from mavstack.server.json_values import to_json
from mavstack.vehicle.firmware.msp import MspFirmware

if TYPE_CHECKING:
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.vehicle import Vehicle

#: Telemetry in the answer about a vehicle: names of properties of `Vehicle`.
TELEMETRY: Final = (
    "position",
    "local_position",
    "velocity",
    "attitude",
    "heading",
    "ground_speed",
    "climb_rate",
    "vfr_hud",
    "gps",
    "battery",
    "batteries",
    "home",
    "wind",
    "rc",
    "imu",
    "armed",
    "mode",
    "in_air",
    "landed_state",
    "vtol_state",
    "system_status",
)
#: Maximum number of status texts in an answer; the newest ones are sent.
MAX_TEXTS: Final = 100
_SYSTEM: Final = "/api/vehicles/{system}"


def identity_json(vehicle: Vehicle) -> dict[str, Any]:
    """Return the identity and the state of a vehicle as JSON."""
    health = vehicle.health
    return {
        "system": vehicle.system,
        "component": vehicle.address.component,
        "alive": vehicle.alive,
        "type": str(vehicle.vehicle_type),
        "mav_type": to_json(vehicle.mav_type),
        "autopilot": to_json(vehicle.autopilot),
        "firmware": vehicle.firmware.NAME,
        "identifier": vehicle.identifier,
        "armed": vehicle.armed,
        "mode": vehicle.mode,
        "in_air": vehicle.in_air,
        "ready": health.ready,
        "problems": [to_json(each) for each in health.problems],
        "warnings": [to_json(each) for each in health.warnings],
        "has_id_conflict": vehicle.has_id_conflict,
        "conflict": conflict_json(vehicle),
        "unsaved_parameters": len(vehicle.params.unsaved),
        "position": to_json(vehicle.position),
    }


def telemetry_json(vehicle: Vehicle) -> dict[str, Any]:
    """Return the telemetry of a vehicle as JSON; null is unknown."""
    values = {name: to_json(getattr(vehicle, name)) for name in TELEMETRY}
    progress = vehicle.mission.progress
    own = {"system": vehicle.system, "conflict": conflict_json(vehicle)}
    return {**own, **values, "mission": to_json(progress), **texts_json(vehicle)}


def texts_json(vehicle: Vehicle) -> dict[str, Any]:
    """Return the newest status texts of a vehicle as JSON, and the present time by their clock."""
    return {"time": vehicle.telemetry.now(), "status_texts": to_json(vehicle.status_texts[-MAX_TEXTS:])}


_EXAMPLE: Final = {
    "system": 1,
    "component": 1,
    "alive": True,
    "type": "copter",
    "mav_type": "QUADROTOR",
    "autopilot": "ARDUPILOTMEGA",
    "firmware": "ArduPilot",
    "identifier": "",
    "armed": False,
    "mode": "STABILIZE",
    "in_air": False,
    "ready": True,
    "problems": [],
    "warnings": [{"text": "GPS has no 3D fix (4 satellites)", "source": "GPS_RAW_INT"}],
    "has_id_conflict": False,
    "conflict": None,
    "unsaved_parameters": 0,
    "position": {
        "latitude": 47.3977,
        "longitude": 8.5456,
        "altitude": 488.1,
        "relative_altitude": 0.0,
        "heading": 90.0,
    },
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "vehicles")


@ROUTES.add("GET", "/api/vehicles", "List the vehicles that were found", answer=[_EXAMPLE])
async def _list(call: PlainCall) -> list[dict[str, Any]]:
    return [identity_json(vehicle) for vehicle in call.station.connection.vehicles.values()]


@ROUTES.add(
    "GET",
    _SYSTEM,
    "Show a vehicle: identity, capabilities, version, components, status texts",
    answer=_EXAMPLE,
)
async def _show(call: PlainCall) -> dict[str, Any]:
    vehicle = call.vehicle
    version = vehicle.version
    return {
        **identity_json(vehicle),
        "home": to_json(vehicle.home),
        "capabilities": {**to_json(vehicle.capabilities), "msp": isinstance(vehicle.firmware, MspFirmware)},
        "version": None if version is None else _version(version),
        "components": [_component(info) for info in vehicle.components.values()],
        **texts_json(vehicle),
    }


@ROUTES.add(
    "GET",
    f"{_SYSTEM}/telemetry",
    "Show the latest telemetry of a vehicle",
    answer={"system": 1, "attitude": {"roll": 0.5, "pitch": -1.2, "yaw": 90.0}, "mode": "GUIDED"},
)
async def _telemetry(call: PlainCall) -> dict[str, Any]:
    return telemetry_json(call.vehicle)


@ROUTES.add(
    "GET",
    f"{_SYSTEM}/modes",
    "List the flight modes of a vehicle",
    answer=[{"name": "GUIDED", "number": 4, "standard_mode": 0, "selectable": True, "advanced": False}],
)
async def _modes(call: PlainCall) -> list[dict[str, Any]]:
    vehicle = call.vehicle
    modes = await call.read("modes", vehicle.modes.list)
    return [
        {
            "name": mode.name,
            "number": mode.custom_mode,
            "standard_mode": int(mode.standard_mode),
            "selectable": mode.selectable,
            "advanced": mode.advanced,
        }
        for mode in modes
    ]


def _version(version: object) -> Any:  # noqa: ANN401 (JSON)
    if not is_dataclass(version) or isinstance(version, type):
        return str(version)
    return to_json({each.name: getattr(version, each.name) for each in fields(version)})


def _component(info: ComponentInfo) -> dict[str, Any]:
    values = asdict(info) | {"address": list(info.address)}
    return {key: to_json(value) for key, value in values.items()}
