"""The extended parameters of a component, such as a camera: texts and numbers of all sizes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final

from msgspec import Meta

from mavstack.dialects import common
from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call
from mavstack.server.json_values import to_json
from mavstack.server.request_types import Text

if TYPE_CHECKING:
    from mavstack.node.extended_params import ExtendedParams
    from mavstack.services.extended_parameters import ExtendedParameter

_ALL: Final = "/api/vehicles/{system}/components/{component}/extended-parameters"
_TYPES: Final = common.MavParamExtType
MAX_COMPONENT: Final = 255


class SetExtendedParameter(Fields):
    """Set an extended parameter of a component."""

    value: Annotated[float | Text, Meta(description="A number or a text.", examples=[1])]


def extended_json(parameter: ExtendedParameter) -> dict[str, Any]:
    """Return an extended parameter as JSON; bytes are hexadecimal."""
    value = parameter.value
    known = parameter.type in _TYPES.__members__.values()
    return {
        "name": parameter.name,
        "value": value.hex() if isinstance(value, bytes) else to_json(value),
        "type": _TYPES(parameter.type).name if known else int(parameter.type),
    }


def _params(call: Call[Any, Any]) -> ExtendedParams:
    text, vehicle = call.path("component"), call.vehicle
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:6]) <= MAX_COMPONENT):
        raise RefusedError(404, f"ids of components are numbers from 1 to {MAX_COMPONENT}")
    return vehicle.connection.component(vehicle.system, int(text)).extended_params


_EXAMPLE: Final = {"name": "CAM_MODE", "value": 0, "type": "UINT32"}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "parameters")


@ROUTES.add("GET", _ALL, "Download the extended parameters of a component", answer={"parameters": [_EXAMPLE]})
async def _list(call: Call[None, Wait]) -> dict[str, Any]:
    params = _params(call)
    subject = f"extended parameters of {call.path('component')}"
    found = await call.read(subject, lambda: params.download(progress=call.progress))
    return {"parameters": [extended_json(found[name]) for name in sorted(found)]}


@ROUTES.add(
    "PUT",
    f"{_ALL}/{{name}}",
    path_examples={"name": "CAM_MODE"},
    role=Role.ADMINISTER,
    writes=True,
    answer=_EXAMPLE,
)
async def _set(call: Call[SetExtendedParameter, None]) -> dict[str, Any]:
    params, name, value = _params(call), call.path("name"), call.body.value
    before = await params.get(name)
    if isinstance(before.value, int) and isinstance(value, float) and value.is_integer():
        value = int(value)
    return extended_json(await params.set(name, value))
