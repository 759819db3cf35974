"""INJECT_FAILURE: PX4's failures as faults of the simulated vehicle.

GPS             off, stuck: no fix                  wrong: wrong position
compass         off, stuck, wrong: wrong heading
barometer       off, stuck, wrong: offset of some metres
battery         off: nearly empty
motor, ESC      off: stopped
RC signal       off: the transmitter is silent, if there is one
MAVLink signal  off: nothing is received any more, not even the command that would end it
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.commands import CommandGroup, Handlers, number, whole
from mavstack.sim.motion.airframes import AIRFRAMES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.services.command import CommandRequest
    from mavstack.sim.vehicle import SimulatedVehicle

_CMD, _RESULT = common.MavCmd, common.MavResult
_UNIT, _TYPE = common.FailureUnit, common.FailureType

#: Failure units by their names in the `failure` command of the shell; `TYPES` has the failure types.
UNITS: Final[Mapping[str, int]] = MappingProxyType(
    {
        "mag": _UNIT.SENSOR_MAG,
        "baro": _UNIT.SENSOR_BARO,
        "gps": _UNIT.SENSOR_GPS,
        "battery": _UNIT.SYSTEM_BATTERY,
        "motor": _UNIT.SYSTEM_MOTOR,
        "esc": _UNIT.SYSTEM_ESC,
        "rc_signal": _UNIT.SYSTEM_RC_SIGNAL,
        "mavlink_signal": _UNIT.SYSTEM_MAVLINK_SIGNAL,
    }
)
TYPES: Final[Mapping[str, int]] = MappingProxyType(
    {"ok": _TYPE.OK, "off": _TYPE.OFF, "stuck": _TYPE.STUCK, "wrong": _TYPE.WRONG}
)
_FAULT_COMMANDS: Final[Mapping[tuple[int, int], tuple[str, ...]]] = MappingProxyType(
    {
        (_UNIT.SENSOR_GPS, _TYPE.OK): ("gps on", "gps spoof 0 0"),
        (_UNIT.SENSOR_GPS, _TYPE.OFF): ("gps off",),
        (_UNIT.SENSOR_GPS, _TYPE.STUCK): ("gps off",),
        (_UNIT.SENSOR_GPS, _TYPE.WRONG): ("gps spoof 300 200",),
        (_UNIT.SENSOR_MAG, _TYPE.OK): ("compass 0",),
        (_UNIT.SENSOR_MAG, _TYPE.OFF): ("compass 180",),
        (_UNIT.SENSOR_MAG, _TYPE.STUCK): ("compass 90",),
        (_UNIT.SENSOR_MAG, _TYPE.WRONG): ("compass 60",),
        (_UNIT.SENSOR_BARO, _TYPE.OK): ("baro 0",),
        (_UNIT.SENSOR_BARO, _TYPE.OFF): ("baro 40",),
        (_UNIT.SENSOR_BARO, _TYPE.STUCK): ("baro 20",),
        (_UNIT.SENSOR_BARO, _TYPE.WRONG): ("baro 15",),
        (_UNIT.SYSTEM_BATTERY, _TYPE.OK): ("battery 100",),
        (_UNIT.SYSTEM_BATTERY, _TYPE.OFF): ("battery 4",),
        (_UNIT.SYSTEM_MAVLINK_SIGNAL, _TYPE.OK): ("link on",),
        (_UNIT.SYSTEM_MAVLINK_SIGNAL, _TYPE.OFF): ("link off",),
    }
)
_RADIO_FAULTS: Final = MappingProxyType({_TYPE.OK: "radio on", _TYPE.OFF: "radio off"})
_MOTOR_STATES: Final = MappingProxyType({_TYPE.OK: "on", _TYPE.OFF: "off"})
_MOTOR_UNITS: Final = frozenset({_UNIT.SYSTEM_MOTOR, _UNIT.SYSTEM_ESC})


class FailureCommands(CommandGroup):
    """INJECT_FAILURE."""

    def handlers(self) -> Handlers:
        return {_CMD.INJECT_FAILURE: self.inject}

    def inject(self, request: CommandRequest) -> common.MavResult:
        """Answer INJECT_FAILURE: unit, type, and instance (0 is all)."""
        command = request.command
        unit, kind = whole(command.param1), whole(command.param2)
        instance = whole(number(command.param3))
        if not int(self.vehicle.parameters["SYS_FAILURE_EN"]) or instance is None or instance < 0:
            return _RESULT.DENIED
        if unit is None or kind is None:
            return _RESULT.DENIED
        if not faults_for(self.vehicle, unit, kind, instance):
            return _RESULT.UNSUPPORTED
        inject(self.vehicle, unit, kind, instance)
        return _RESULT.ACCEPTED


def faults_for(vehicle: SimulatedVehicle, unit: int, kind: int, instance: int) -> tuple[str, ...]:
    """Return the faults that simulate a failure; empty if unsupported."""
    if unit in _MOTOR_UNITS and kind in _MOTOR_STATES:
        motors = AIRFRAMES[vehicle.vehicle_type].motors
        numbers = range(1, motors + 1) if instance == 0 else range(instance, min(instance, motors) + 1)
        return tuple(f"motor {motor} {_MOTOR_STATES[common.FailureType(kind)]}" for motor in numbers)
    if unit == _UNIT.SYSTEM_RC_SIGNAL and kind in _RADIO_FAULTS and vehicle.autopilot.radio.has_transmitter:
        return (_RADIO_FAULTS[common.FailureType(kind)],)
    return _FAULT_COMMANDS.get((unit, kind), ())


def inject(vehicle: SimulatedVehicle, unit: int, kind: int, instance: int) -> None:
    """Inject a failure and report it; a link is cut only after the report was sent."""
    name = next(name for name, number in UNITS.items() if number == unit)
    word = next(word for word, number in TYPES.items() if number == kind)
    which = f"instance {instance}" if instance else "all instances"
    text = f"Cleared: {name}, {which}" if kind == _TYPE.OK else f"Injected: {name} {word}, {which}"
    vehicle.send_statustext(text, common.MavSeverity.WARNING)
    faults = faults_for(vehicle, unit, kind, instance)
    if unit == _UNIT.SYSTEM_MAVLINK_SIGNAL:
        vehicle.autopilot.tasks.on_next_tick(lambda: _inject_all(vehicle, faults))
    else:
        _inject_all(vehicle, faults)


def _inject_all(vehicle: SimulatedVehicle, faults: tuple[str, ...]) -> None:
    """Inject faults."""
    for fault in faults:
        vehicle.faults.inject(fault)
