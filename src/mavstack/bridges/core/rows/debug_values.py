"""Rows of debug values, which firmware developers send."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.qos import DEFAULT
from mavstack.bridges.core.row import Converter, Publication, Source, Values
from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.bridges.core.view import VehicleView
    from mavstack.dialects import Message

_DEBUG, _VECTOR, _ARRAY, _FLOAT, _INT = range(5)


def debug(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/DebugValue of DEBUG."""
    return message.ind, -1, "", message.value, 0, (), _DEBUG


def debug_vector(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/DebugValue of DEBUG_VECT."""
    return -1, -1, message.name, 0.0, 0, (message.x, message.y, message.z), _VECTOR


def debug_array(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/DebugValue of DEBUG_FLOAT_ARRAY."""
    return -1, message.array_id, message.name, 0.0, 0, tuple(message.data), _ARRAY


def named_float(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/DebugValue of NAMED_VALUE_FLOAT."""
    return -1, -1, message.name, message.value, 0, (), _FLOAT


def named_int(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/DebugValue of NAMED_VALUE_INT."""
    return -1, -1, message.name, 0.0, message.value, (), _INT


def _row(name: str, source: type[Message], convert: Converter) -> Publication:
    kind = "mavros_msgs/msg/DebugValue"
    return Publication(f"debug_value/{name}", kind, (source,), convert, DEFAULT, source=Source.SYSTEM)


ROWS: Final = (
    _row("debug", common.Debug, debug),
    _row("debug_vector", common.DebugVect, debug_vector),
    _row("debug_float_array", common.DebugFloatArray, debug_array),
    _row("named_value_float", common.NamedValueFloat, named_float),
    _row("named_value_int", common.NamedValueInt, named_int),
)
