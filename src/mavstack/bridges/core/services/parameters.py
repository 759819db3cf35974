"""Services of parameters: those of MAVROS, and ROS parameters of the node `param`."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.row import Handler, Service
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, MavstackError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from mavstack.bridges.core.row import Values
    from mavstack.services.parameters import Parameter
    from mavstack.vehicle import Vehicle

Fields = dict[str, Any]
#: Types of rcl_interfaces/ParameterType.
NOT_SET, BOOL, INTEGER, DOUBLE, STRING = range(5)
_REALS: Final = (common.MavParamType.REAL32, common.MavParamType.REAL64)
_UNKNOWN_INDEX: Final = 0xFFFF


def ros_value(parameter: Parameter) -> Fields:
    """Return rcl_interfaces/ParameterValue of a parameter."""
    if parameter.type in _REALS:
        return {"type": DOUBLE, "double_value": float(parameter.value)}
    return {"type": INTEGER, "integer_value": int(parameter.value)}


def event_values(parameter: Parameter, count: int) -> Values:
    """Return mavros_msgs/ParamEvent behind its header."""
    real = parameter.type in _REALS
    integer, double = (0, float(parameter.value)) if real else (int(parameter.value), 0.0)
    value = (DOUBLE if real else INTEGER, False, integer, double, "", b"", (), (), (), ())
    index = _UNKNOWN_INDEX if parameter.index is None else parameter.index
    return parameter.name, *value, index, min(count, _UNKNOWN_INDEX)


def number_of(fields: Fields) -> float:
    """Return the number in a rcl_interfaces/ParameterValue.

    Raises:
        InvalidArgumentError: It is not a number.
    """
    names = {BOOL: "bool_value", INTEGER: "integer_value", DOUBLE: "double_value"}
    name = names.get(fields["type"])
    if name is None:
        raise InvalidArgumentError("the value of a parameter must be a number")
    value = fields[name]
    return int(value) if isinstance(value, bool) else value


async def pull(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Download all parameters (mavros_msgs/ParamPull)."""
    known = vehicle.params.cached
    if request["force_pull"] or not vehicle.params.is_complete:
        known = await vehicle.params.download()
    return {"success": True, "param_received": len(known)}


async def set_parameter(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Set a parameter (mavros_msgs/ParamSetV2)."""
    parameter = await vehicle.params.set(request["param_id"], number_of(request["value"]))
    return {"success": True, "value": ros_value(parameter)}


async def list_parameters(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """List the names of parameters (rcl_interfaces/ListParameters)."""
    known = vehicle.params.cached if vehicle.params.is_complete else await vehicle.params.download()
    prefixes = request["prefixes"]
    names = [name for name in known if not prefixes or any(name.startswith(each) for each in prefixes)]
    return {"result": {"names": sorted(names)}}


async def get_parameters(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Return values by name (rcl_interfaces/GetParameters); unknown ones are not set."""
    return {"values": [await _value(vehicle, name) for name in request["names"]]}


async def _value(vehicle: Vehicle, name: str) -> Fields:
    known = vehicle.params.cached.get(name)
    if known is None:
        with suppress(MavstackError):
            known = await vehicle.params.get(name)
    return {"type": NOT_SET} if known is None else ros_value(known)


async def get_types(vehicle: Vehicle, request: Fields, context: Any) -> Fields:
    """Return types by name (rcl_interfaces/GetParameterTypes)."""
    found = await get_parameters(vehicle, request, context)
    return {"types": [value["type"] for value in found["values"]]}


async def describe(vehicle: Vehicle, request: Fields, context: Any) -> Fields:
    """Describe parameters (rcl_interfaces/DescribeParameters)."""
    types = (await get_types(vehicle, request, context))["types"]
    metadata = vehicle.params.metadata
    described = []
    for name, kind in zip(request["names"], types, strict=True):
        known = metadata.get(name)
        text = "" if known is None else known.short_description
        described.append({"name": name, "type": kind, "description": text})
    return {"descriptors": described}


async def set_parameters(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Set parameters one by one (rcl_interfaces/SetParameters)."""
    return {"results": [await _set(vehicle, each) for each in request["parameters"]]}


async def _set(vehicle: Vehicle, fields: Fields) -> Fields:
    try:
        await vehicle.params.set(fields["name"], number_of(fields["value"]))
    except MavstackError as error:
        return {"successful": False, "reason": str(error)}
    return {"successful": True}


async def set_atomically(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Set parameters; if one is refused, those before it get their values back."""
    before: list[tuple[str, float]] = []
    for fields in request["parameters"]:
        try:
            value = number_of(fields["value"])
            before.append((fields["name"], (await vehicle.params.get(fields["name"])).value))
            await vehicle.params.set(fields["name"], value)
        except MavstackError as error:
            for name, old in reversed(before):
                with suppress(MavstackError):
                    await vehicle.params.set(name, old)
            return {"result": {"successful": False, "reason": str(error)}}
    return {"result": {"successful": True}}


def _ros(name: str, kind: str, handle: Handler, role: Role) -> Service:
    return Service(
        f"param/{name}", f"rcl_interfaces/srv/{kind}", handle, role, "parameters of the node param"
    )


ROWS: Final = (
    Service("param/pull", "mavros_msgs/srv/ParamPull", pull, Role.OBSERVE, "PARAM_REQUEST_LIST"),
    Service("param/set", "mavros_msgs/srv/ParamSetV2", set_parameter, Role.ADMINISTER, "PARAM_SET"),
    _ros("list_parameters", "ListParameters", list_parameters, Role.OBSERVE),
    _ros("get_parameters", "GetParameters", get_parameters, Role.OBSERVE),
    _ros("get_parameter_types", "GetParameterTypes", get_types, Role.OBSERVE),
    _ros("describe_parameters", "DescribeParameters", describe, Role.OBSERVE),
    _ros("set_parameters", "SetParameters", set_parameters, Role.ADMINISTER),
    _ros("set_parameters_atomically", "SetParametersAtomically", set_atomically, Role.ADMINISTER),
)
