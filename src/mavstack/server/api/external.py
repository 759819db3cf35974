"""Measurements of companion computers for a vehicle, and whether its estimator uses them."""

from __future__ import annotations

from typing import Annotated, Any, Final, TypeAlias, cast

from msgspec import Meta, Struct, defstruct

from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.vehicle.external.records import KINDS, arguments_of, send_record

_PATH: Final = "/api/vehicles/{system}/external"
#: Kinds that need only the role `operate`: a target to follow is part of a flight. The other kinds give the
#: vehicle's position, or the surroundings.
_OPERATED: Final = frozenset({"follow-target"})
_PARTS: Final = frozenset({"position", "yaw"})
_MAX_NUMBERS: Final = 72
_Values: TypeAlias = dict[
    str, str | float | Annotated[list[float | None], Meta(max_length=_MAX_NUMBERS)] | None
]
_POSE: Final = {"position": [1.0, 2.0, 3.0], "orientation": [1.0, 0.0, 0.0, 0.0], "frame": "ENU"}
_PLACE: Final = {"latitude": 47.3977, "longitude": 8.5456, "altitude": 488.0}
#: An example of each kind for the description of the API.
_EXAMPLES: Final = {
    "odometry": _POSE,
    "vision": _POSE,
    "mocap": _POSE,
    "gps": _PLACE,
    "landing-target": {"forward": 0.4, "right": -0.2, "down": 6.0},
    "obstacles": {"distances": [5.0, None, 3.2], "increment": 5.0},
    "distance": {"distance": 2.4},
    "follow-target": _PLACE,
    "wind": {"speed": 6.5, "direction": 240.0},
}


class Measurement(Fields):
    """A measurement of a companion computer."""

    values: _Values


class Sent(Struct):
    """The kind of a measurement that was sent, and the number of estimates that the station sent."""

    kind: str
    estimates: int


class EstimatorUse(Struct):
    """The use of estimates by the estimator: the reasons against it, and the stream of the station."""

    used: bool
    reasons: list[str]
    sent: int
    rate_hz: float
    delay_s: float | None


ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "vehicles")


@ROUTES.add(
    "GET",
    _PATH,
    "Find out whether the estimator of a vehicle uses external estimates",
    answer={
        "used": False,
        "reasons": ["VISO_TYPE is 0: set it to 1 (MAVLink), and reboot"],
        "sent": 0,
        "rate_hz": 0.0,
        "delay_s": None,
    },
    answer_model=EstimatorUse,
)
async def _check(call: PlainCall) -> EstimatorUse:
    external = call.vehicle.external
    parts = frozenset() if external.monitor.rate(external.vehicle.component.now()) else _PARTS

    async def read() -> EstimatorUse:
        status = await external.check(parts=parts)
        return EstimatorUse(status.is_used, list(status.reasons), status.sent, status.rate, status.delay)

    return await call.read("external", read)


def _body(kind: str) -> type[Measurement]:
    """Return the model of a kind, whose description has its example."""
    text = "The arguments by their names; null in a list is not known."
    values = Annotated[_Values, Meta(description=text, examples=[_EXAMPLES[kind]])]
    name = f"{kind.title().replace('-', '')}Measurement"
    made = defstruct(
        name, [("values", values)], bases=(Measurement,), namespace={"__doc__": Measurement.__doc__}
    )
    return cast("type[Measurement]", made)


def _route(kind: str) -> AnyRoute:
    async def handler(call: Call[Measurement, None]) -> dict[str, Any]:
        external = call.vehicle.external
        await send_record(external, kind, call.body.values)
        return {"kind": kind, "estimates": external.monitor.sent}

    return ApiRoute(
        method="POST",
        path=f"{_PATH}/{kind}",
        handler=handler,
        summary=f"Send {kind.replace('-', ' ')} to a vehicle: {', '.join(arguments_of(kind))}",
        tag="vehicles",
        role=Role.OPERATE if kind in _OPERATED else Role.ADMINISTER,
        body=_body(kind),
        answer={"kind": kind, "estimates": 0},
        answer_model=Sent,
    )


ROUTES.extend(map(_route, KINDS))
