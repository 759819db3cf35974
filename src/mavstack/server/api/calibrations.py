"""The calibrations of a vehicle.

A calibration is long work: with `wait=false` it is a task, whose progress has the step at which it is. A step
with `needs_confirmation` waits for a request that confirms it. One that the vehicle cannot cancel is followed
no more: `cancelled` is false then. A calibration that is no task is cancelled when its client leaves, since
no person would confirm its steps or see motors turn.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final, TypeVar

from starlette.requests import ClientDisconnect

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import NoFields, RouteTable, Wait
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.calibrations import step_json
from mavstack.server.json_values import to_json
from mavstack.server.request_types import Timeout
from mavstack.vehicle import CalibrationKind

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from starlette.requests import Request

    from mavstack.vehicle import CalibrationSession

Result = TypeVar("Result")
_ALL: Final = "/api/vehicles/{system}/calibrations"
_ONE: Final = f"{_ALL}/{{kind}}"


class Calibrate(Fields):
    """Calibrate a sensor, the radio control or the motors."""

    timeout: Timeout = None


_STEP: Final[dict[str, Any]] = {
    "kind": "accelerometer",
    "task": "place",
    "text": "Place the vehicle on its left side.",
    "pose": "on its left side",
    "pending": [],
    "progress": None,
    "needs_confirmation": True,
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "calibrations")


@ROUTES.add(
    "GET",
    _ALL,
    "List the calibrations that a vehicle has",
    answer=[
        {
            "kind": "accelerometer",
            "needs_confirmation": True,
            "can_cancel": False,
            "running": True,
            "step": _STEP,
        }
    ],
)
async def _list(call: PlainCall) -> list[dict[str, Any]]:
    vehicle = call.vehicle
    running = call.station.calibrations.session(vehicle.system)
    return [
        {
            "kind": str(kind),
            "needs_confirmation": vehicle.calibration.needs_confirmation(kind),
            "can_cancel": vehicle.calibration.can_cancel(kind),
            "running": running is not None and running.kind == kind,
            "step": step_json(running) if running is not None and running.kind == kind else None,
        }
        for kind in vehicle.calibration.kinds
    ]


@ROUTES.add(
    "POST",
    _ONE,
    "Calibrate a sensor, the radio control or the motors",
    role=Role.ADMINISTER,
    answer={"system": 1, "kind": "accelerometer", "reboot_needed": True, "compasses": [], "channels": {}},
)
async def _run(call: Call[Calibrate, Wait]) -> dict[str, Any]:
    def report(step: dict[str, Any]) -> None:
        if call.task is not None:
            call.task.report_step(step)
            if step["progress"] is not None:
                call.task.report(step["progress"], 100)

    vehicle, timeout = call.vehicle, call.body.timeout
    work = call.station.calibrations.run(vehicle, _kind(call), report, timeout=timeout)
    result = await (work if call.task is not None else _while_connected(call.request, work))
    return {"system": vehicle.system, **to_json(result)}


async def _while_connected(request: Request, work: Coroutine[Any, Any, Result]) -> Result:
    """Return the result of work that is cancelled if the client leaves; raises `ClientDisconnect` then."""
    loop = asyncio.get_running_loop()
    working, leaving = loop.create_task(work), loop.create_task(_disconnected(request))
    try:
        await asyncio.wait([working, leaving], return_when=asyncio.FIRST_COMPLETED)
        if not working.done():
            raise ClientDisconnect
        return working.result()
    finally:
        for task in (working, leaving):
            task.cancel()
        await asyncio.gather(working, leaving, return_exceptions=True)


async def _disconnected(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


@ROUTES.add(
    "POST",
    f"{_ONE}/confirm",
    "Confirm that the task of the step is done",
    role=Role.ADMINISTER,
    answer={"system": 1, "kind": "accelerometer", "step": _STEP},
)
async def _confirm(call: Call[NoFields, None]) -> dict[str, Any]:
    session = _session(call)
    await session.confirm()
    return {"system": call.vehicle.system, "kind": str(session.kind), "step": step_json(session)}


@ROUTES.add(
    "DELETE",
    _ONE,
    "Cancel a calibration",
    role=Role.ADMINISTER,
    answer={"system": 1, "kind": "compass", "cancelled": True},
)
async def _cancel(call: PlainCall) -> dict[str, Any]:
    kind = _kind(call)
    await call.station.calibrations.cancel(call.vehicle, kind)
    cancelled = call.vehicle.calibration.can_cancel(kind)
    return {"system": call.vehicle.system, "kind": kind, "cancelled": cancelled}


def _kind(call: Call[Any, Any]) -> str:
    kind = call.path("kind")
    if kind not in tuple(CalibrationKind):
        raise RefusedError(404, f"there is no calibration {kind[:60]!r}: {', '.join(CalibrationKind)}")
    return kind


def _session(call: Call[Any, Any]) -> CalibrationSession:
    session = call.station.calibrations.session(call.vehicle.system, _kind(call))
    if session is None:
        raise RefusedError(409, f"no {_kind(call)} calibration of vehicle {call.vehicle.system} runs")
    return session
