"""Setting a vehicle up: the check list before a first flight, the airframe, the serial ports."""

from __future__ import annotations

from typing import Annotated, Any, Final

from msgspec import Meta, Struct

from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call
from mavstack.vehicle.setup import (
    airframe_choices,
    first_flight,
    get_airframe,
    get_serial_ports,
    plan_airframe,
    serial_protocols,
    set_airframe,
    set_serial_port,
)
from mavstack.vehicle.setup.json_text import airframe_json, check_json, choices_json, port_json

_VEHICLE: Final = "/api/vehicles/{system}"


class CheckListItem(Struct):
    """An item of the check list; the state is ok, missing, advice or unknown."""

    name: str
    state: str
    text: str
    remedy: str


class CheckList(Struct):
    """The check list before a first flight."""

    items: list[CheckListItem]


class Choice(Struct):
    """A number with its name."""

    number: int
    name: str


class AirframeFacts(Struct):
    """The airframe: its parameters by name."""

    name: str
    values: dict[str, int]
    defined: bool


class AirframeAnswer(AirframeFacts):
    """The airframe, and the ones that have names; `types` are those of FRAME_TYPE."""

    airframes: list[Choice]
    types: list[Choice]


class PlannedAirframe(Struct):
    """The change to another airframe, and the airframe afterwards; null for a dry run."""

    sets: dict[str, int]
    resets: bool
    keeps: list[str]
    airframe: AirframeFacts | None


class SerialPortFacts(Struct):
    """A serial port of the board; `number` is the protocol of ArduPilot, or functions as bits."""

    name: str
    protocol: str
    number: int | None
    baud: int
    parameters: list[str]


class SerialPorts(Struct):
    """The serial ports of the board; the numbers of `protocols` add up if they are `combined`."""

    ports: list[SerialPortFacts]
    protocols: list[Choice]
    combined: bool


class SetAirframe(Fields):
    """Change the airframe, and restart the vehicle."""

    airframe: Annotated[
        int, Meta(description="SYS_AUTOSTART or FRAME_CLASS.", ge=0, le=2**31 - 1, examples=[1])
    ]
    frame_type: Annotated[
        Annotated[int, Meta(ge=0, le=127)] | None,
        Meta(description="FRAME_TYPE of ArduPilot; null: as it is."),
    ] = None
    reset: Annotated[bool, Meta(description="Let PX4 reset its parameters.")] = True
    dry_run: Annotated[bool, Meta(description="Only show what would change.")] = False


class SetSerialPort(Fields):
    """Set protocol and rate of a serial port; it takes effect after a restart."""

    protocol: Annotated[
        Annotated[int, Meta(ge=-1, le=2**31 - 1)] | None,
        Meta(
            description="The protocol of an ArduPilot port, or the functions of a port of Betaflight or iNav"
            " as bits; null: as it is.",
            examples=[2],
        ),
    ] = None
    baud: Annotated[
        Annotated[int, Meta(ge=0, le=12_500_000)] | None,
        Meta(description="Bits per second; null: as it is."),
    ] = None


_AIRFRAME: Final = {"name": "quad, X", "values": {"FRAME_CLASS": 1, "FRAME_TYPE": 1}, "defined": True}
_PORT: Final = {
    "name": "SERIAL1",
    "protocol": "MAVLink 2",
    "number": 2,
    "baud": 57600,
    "parameters": ["SERIAL1_PROTOCOL", "SERIAL1_BAUD"],
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "setup")


@ROUTES.add(
    "GET",
    f"{_VEHICLE}/first-flight",
    "Show what is missing before a first flight",
    answer={"items": [{"name": "compass", "state": "ok", "text": "calibrated", "remedy": ""}]},
    answer_model=CheckList,
)
async def _check(call: Call[None, Wait]) -> dict[str, Any]:
    vehicle = call.vehicle
    items = await call.read("first flight", lambda: first_flight(vehicle))
    return {"items": [check_json(each) for each in items]}


@ROUTES.add(
    "GET",
    f"{_VEHICLE}/airframe",
    "Show the airframe",
    answer={
        **_AIRFRAME,
        "airframes": [{"number": 1, "name": "quad"}],
        "types": [{"number": 1, "name": "X"}],
    },
    answer_model=AirframeAnswer,
)
async def _airframe(call: Call[None, Wait]) -> dict[str, Any]:
    vehicle = call.vehicle
    choices = airframe_choices(vehicle)
    found = airframe_json(await call.read("airframe", lambda: get_airframe(vehicle)))
    return {**found, "airframes": choices_json(choices.airframes), "types": choices_json(choices.types)}


@ROUTES.add(
    "PUT",
    f"{_VEHICLE}/airframe",
    role=Role.ADMINISTER,
    writes=True,
    answer={"sets": {"FRAME_CLASS": 1}, "resets": False, "keeps": [], "airframe": _AIRFRAME},
    answer_model=PlannedAirframe,
)
async def _set_airframe(call: Call[SetAirframe, Wait]) -> dict[str, Any]:
    body, vehicle = call.body, call.vehicle
    change = plan_airframe(vehicle, body.airframe, body.frame_type, reset=body.reset)
    found = None if body.dry_run else airframe_json(await set_airframe(vehicle, change))
    plan = {"sets": dict(change.sets), "resets": change.resets, "keeps": list(change.keeps)}
    return {**plan, "airframe": found}


@ROUTES.add(
    "GET",
    f"{_VEHICLE}/serial-ports",
    "List the serial ports of the board with their protocols",
    answer={"ports": [_PORT], "protocols": [{"number": 2, "name": "MAVLink 2"}], "combined": False},
    answer_model=SerialPorts,
)
async def _ports(call: Call[None, Wait]) -> dict[str, Any]:
    vehicle = call.vehicle
    found = await call.read("serial ports", lambda: get_serial_ports(vehicle))
    ports = [port_json(each) for each in found]
    protocols = choices_json(serial_protocols(vehicle))
    return {"ports": ports, "protocols": protocols, "combined": bool(vehicle.identifier)}


@ROUTES.add(
    "PUT",
    f"{_VEHICLE}/serial-ports/{{name}}",
    path_examples={"name": "SERIAL1"},
    role=Role.ADMINISTER,
    writes=True,
    answer=_PORT,
    answer_model=SerialPortFacts,
)
async def _set_port(call: Call[SetSerialPort, None]) -> dict[str, Any]:
    body = call.body
    return port_json(await set_serial_port(call.vehicle, call.path("name"), body.protocol, body.baud))
