"""The requests that a scripted autopilot received, as plain tuples."""

from __future__ import annotations

from math import isnan

from mavstack.dialects import common
from mavstack.services.message_request.interval import message_id_of
from tests.vehicle.failures.scripted_autopilot import CMD, ScriptedHarness

LONG, INT = "long", "int"
HERE = (47.397742, 8.545594)
THERE = (47.3990, 8.5470)
#: Commands that do not depend on the firmware.
_RATES = (CMD.SET_MESSAGE_INTERVAL, CMD.REQUEST_AUTOPILOT_CAPABILITIES)
_VERSION = message_id_of(common.AutopilotVersion)
NAN = "nan"


def plain(number: float) -> float | str:
    return NAN if isnan(number) else round(number, 5)


def requests_of(harness: ScriptedHarness) -> list[tuple]:
    """Return the commands, parameter settings and setpoints, in their order."""
    found: list[tuple] = []
    for message in harness.autopilot.received:
        match message:
            case common.CommandLong(command=CMD.REQUEST_MESSAGE, param1=param) if param == _VERSION:
                continue  # for the encoding of parameters
            case common.CommandLong(command=command) if command not in _RATES:
                params = [getattr(message, f"param{number}") for number in range(1, 8)]
                found.append((LONG, command.name, *map(plain, params)))
            case common.CommandInt(command=command) if command not in _RATES:
                params = [getattr(message, f"param{number}") for number in range(1, 5)]
                place = (message.x / 1e7, message.y / 1e7, message.z)
                found.append((INT, command.name, message.frame.name, *map(plain, (*params, *place))))
            case common.ParamSet():
                found.append(("set", message.param_id, round(message.param_value, 3)))
            case common.SetPositionTargetGlobalInt():
                place = (message.lat_int / 1e7, message.lon_int / 1e7, message.alt)
                found.append(("setpoint", message.coordinate_frame.name, *map(plain, place)))
    return found


def mode(number: float, sub: float = 0) -> tuple:
    """Return a DO_SET_MODE with the flag for a custom mode, for an armed vehicle."""
    return (LONG, "DO_SET_MODE", 129, number, sub, 0, 0, 0, 0)
