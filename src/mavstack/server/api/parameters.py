"""The parameters of a vehicle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final

from msgspec import Meta, Struct

from mavstack.dialects import common
from mavstack.errors import RemoteDenied, RemoteProtocolError, RemoteTimeout
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait
from mavstack.security.roles import Role
from mavstack.server.api.action_route import Action, action_route
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.json_values import to_json

if TYPE_CHECKING:
    from collections.abc import Container

    from mavstack.services.parameters import MetadataTable, Parameter
    from mavstack.vehicle import Vehicle

_TYPES: Final = common.MavParamType
_ALL: Final = "/api/vehicles/{system}/parameters"
_ONE: Final = f"{_ALL}/{{name}}"


class ParameterValue(Struct):
    """A parameter of a vehicle; `text` is its value in files, `saved` is False if a restart reverts it."""

    name: str
    value: float | None
    text: str
    type: str | int
    saved: bool = True


class Parameters(Struct):
    """The parameters of a vehicle; `unsaved` are the names that a restart reverts until they are saved."""

    parameters: list[ParameterValue]
    unsaved: list[str]


class ParametersQuery(Wait):
    """The query of all parameters."""

    cached: Annotated[
        bool, Meta(description="Answer with the parameters received so far, if there are any.")
    ] = False


class SetParameter(Fields):
    """Set a parameter."""

    value: Annotated[float, Meta(description="The value in the parameter's own unit.", examples=[2000])]
    check: Annotated[bool, Meta(description="Refuse a value that the metadata does not allow.")] = False


class CommitParameters(Action):
    """Save the parameters, so that they outlast a restart."""

    async def run(self, vehicle: Vehicle, wait: bool) -> None:  # noqa: D102
        await vehicle.params.commit(timeout=self.timeout)


def parameter_json(parameter: Parameter, unsaved: Container[str]) -> dict[str, Any]:
    """Return a parameter as JSON."""
    known = parameter.type in _TYPES.__members__.values()
    return {
        "name": parameter.name,
        "value": to_json(parameter.value),
        "text": parameter.text,
        "type": _TYPES(parameter.type).name if known else int(parameter.type),
        "saved": parameter.name not in unsaved,
    }


_EXAMPLE: Final = {"name": "RTL_ALT", "value": 1500.0, "text": "1500", "type": "REAL32", "saved": True}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "parameters")


@ROUTES.add(
    "GET",
    _ALL,
    "Download all parameters",
    answer={"parameters": [_EXAMPLE], "unsaved": []},
    answer_model=Parameters,
)
async def _list(call: Call[None, ParametersQuery]) -> dict[str, Any]:
    params = call.vehicle.params
    cached = params.cached
    if not (call.query.cached and cached):
        cached = await call.read("parameters", lambda: params.download(progress=call.progress))
    unsaved = params.unsaved
    found = [parameter_json(cached[name], unsaved) for name in sorted(cached)]
    return {"parameters": found, "unsaved": list(unsaved)}


@ROUTES.add(
    "GET",
    _ONE,
    "Read a parameter",
    path_examples={"name": "RTL_ALT"},
    answer=_EXAMPLE,
    answer_model=ParameterValue,
)
async def _get(call: PlainCall) -> dict[str, Any]:
    params, name = call.vehicle.params, call.path("name")
    known = params.cached.get(name) if call.role is Role.OBSERVE else None
    if known is None:
        known = await call.read(f"parameter {name}", lambda: params.get(name))
    return parameter_json(known, params.unsaved)


@ROUTES.add(
    "PUT",
    _ONE,
    path_examples={"name": "RTL_ALT"},
    role=Role.ADMINISTER,
    writes=True,
    answer=_EXAMPLE,
    answer_model=ParameterValue,
)
async def _set(call: Call[SetParameter, None]) -> dict[str, Any]:
    body, params = call.body, call.vehicle.params
    found = await params.set(call.path("name"), body.value, check=body.check)
    return parameter_json(found, params.unsaved)


@ROUTES.add(
    "GET",
    "/api/vehicles/{system}/parameter-metadata",
    "Download descriptions, units and ranges of the parameters",
    answer={"metadata": {"RTL_ALT": {"name": "RTL_ALT", "unit": "cm"}}, "problem": None},
)
async def _metadata(call: Call[None, Wait]) -> dict[str, Any]:
    params = call.vehicle.params
    table: MetadataTable = params.metadata
    if not len(table):
        try:
            table = await call.read(
                "parameter metadata", lambda: params.download_metadata(progress=call.progress)
            )
        except (RemoteDenied, RemoteTimeout, RemoteProtocolError) as error:
            return {"metadata": {}, "problem": str(error)}
    names = params.cached or table
    return {"metadata": {name: to_json(table[name]) for name in names if name in table}, "problem": None}


ROUTES.extend([action_route("commit-parameters", CommitParameters, Role.ADMINISTER)])
