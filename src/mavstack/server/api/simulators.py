"""Worlds of real firmware: start, stop, pace and faults."""

from __future__ import annotations

from typing import Annotated, Any, Final

from msgspec import Meta

from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.request_types import Positive, Text
from mavstack.simulators.faults import FAULTS
from mavstack.simulators.firmware_command import VEHICLES
from mavstack.simulators.firmware_session import FIRMWARES, FirmwareOptions


class StartSimulator(Fields):
    """Start a simulated world, in which real firmware flies."""

    firmware: Annotated[Text, Meta(description="px4, ardupilot or betaflight.", examples=["ardupilot"])]
    vehicle: Annotated[
        Text | None, Meta(description="copter, plane, vtol, rover, boat or sub; null: the one of the body.")
    ] = None
    physics: Annotated[
        Text | None,
        Meta(description="The body, such as jsbsim:c172x; null: the one of the vehicle.", examples=["rover"]),
    ] = None
    program: Annotated[
        Text | None,
        Meta(description="The name of a program of the station; null: the firmware is started elsewhere."),
    ] = None
    listen: Annotated[Text | None, Meta(description="Where the firmware connects; null: its usual port.")] = (
        None
    )
    speed: Annotated[Positive, Meta(description="Simulated seconds in a real second; 0: no limit.")] = 1.0
    seed: Annotated[int, Meta(description="Seed of the sensors' noise.")] = 1
    instance: Annotated[
        int, Meta(description="The number of the instance, which shifts all ports.", ge=0)
    ] = 0


class SetPace(Fields):
    """Pause, continue or change the speed of a simulated world."""

    paused: Annotated[bool | None, Meta(description="Pause (true) or continue (false); null: as it is.")] = (
        None
    )
    steps: Annotated[int, Meta(description="With paused: steps to make before the pause.", ge=0)] = 0
    speed: Annotated[Positive | None, Meta(description="The new speed; null: as it is.")] = None


class InjectFault(Fields):
    """Inject a fault of a sensor, or end it."""

    fault: Annotated[Text, Meta(description="The fault, as mav simulator list shows.", examples=["gps-lost"])]
    present: Annotated[bool, Meta(description="False ends the fault.")] = True
    after: Annotated[Positive, Meta(description="Simulated seconds until it begins.")] = 0.0
    duration: Annotated[Positive | None, Meta(description="Simulated seconds; null: no end.")] = None


_EXAMPLE: Final = {
    "id": "1",
    "firmware": "ardupilot",
    "vehicle": "rover",
    "physics": "rover",
    "port": 9002,
    "source": None,
    "time": 12.5,
    "speed": 0.0,
    "paused": False,
    "status": "ArduPilot asks for each step and waits for the answer",
    "faults": [],
    "lines": ["ArduPilot is connected"],
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "simulators")


@ROUTES.add("GET", "/api/simulators", "List the simulated worlds", answer=[_EXAMPLE])
async def _list(call: PlainCall) -> list[dict[str, Any]]:
    return [world.values() for world in call.station.worlds.list()]


@ROUTES.add(
    "GET",
    "/api/simulator-options",
    "List the firmwares, vehicles, physics, faults and programs of simulated worlds",
    answer={
        "firmwares": ["px4"],
        "vehicles": ["copter"],
        "physics": ["copter"],
        "faults": {"gps-lost": "no fix"},
        "programs": [],
    },
)
async def _options(call: PlainCall) -> dict[str, Any]:
    worlds = call.station.worlds
    return {
        "firmwares": list(FIRMWARES),
        "vehicles": list(VEHICLES),
        "physics": worlds.physics,
        "faults": dict(FAULTS),
        "programs": list(worlds.programs),
    }


@ROUTES.add("POST", "/api/simulators", role=Role.ADMINISTER, status=201, answer=_EXAMPLE)
async def _start(call: Call[StartSimulator, None]) -> dict[str, Any]:
    body = call.body
    options = FirmwareOptions(
        body.firmware,
        vehicle=body.vehicle,
        physics=body.physics,
        listen=body.listen,
        speed=body.speed,
        seed=body.seed,
        instance=body.instance,
    )
    return (await call.station.worlds.add(options, body.program)).values()


@ROUTES.add(
    "DELETE",
    "/api/simulators/{id}",
    "Stop a simulated world and its program",
    role=Role.ADMINISTER,
    answer=_EXAMPLE,
)
async def _stop(call: PlainCall) -> dict[str, Any]:
    return (await call.station.worlds.remove(call.path("id"))).values()


@ROUTES.add("POST", "/api/simulators/{id}/pace", role=Role.ADMINISTER, answer=_EXAMPLE)
async def _pace(call: Call[SetPace, None]) -> dict[str, Any]:
    world, body = call.station.worlds.find(call.path("id")), call.body
    simulator = world.session.simulator
    if body.speed is not None:
        simulator.pace.speed = body.speed
    if body.paused:
        simulator.pause(body.steps)
    elif body.paused is not None:
        simulator.resume()
    return world.values()


@ROUTES.add("POST", "/api/simulators/{id}/faults", role=Role.ADMINISTER, answer=_EXAMPLE)
async def _fault(call: Call[InjectFault, None]) -> dict[str, Any]:
    world, body = call.station.worlds.find(call.path("id")), call.body
    if body.present:
        world.session.simulator.inject(body.fault, after=body.after, duration=body.duration)
    else:
        world.session.simulator.clear(body.fault)
    return world.values()
