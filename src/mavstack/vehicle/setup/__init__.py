"""Setting a vehicle up: its airframe, its serial ports, and the check list before its first flight.

    from mavstack.vehicle.setup import first_flight, get_airframe, get_serial_ports

    for item in await first_flight(vehicle):
        print(item)

These are functions of parameters; values that were set are saved.
"""

from mavstack.vehicle.setup.airframe import (
    Airframe,
    AirframeChange,
    AirframeChoices,
    airframe_choices,
    get_airframe,
    plan_airframe,
    set_airframe,
)
from mavstack.vehicle.setup.first_flight import CheckItem, CheckState, first_flight
from mavstack.vehicle.setup.serial_port import SerialPort
from mavstack.vehicle.setup.serial_ports import (
    get_serial_ports,
    serial_protocols,
    set_serial_port,
)

__all__ = [
    "Airframe",
    "AirframeChange",
    "AirframeChoices",
    "CheckItem",
    "CheckState",
    "SerialPort",
    "airframe_choices",
    "first_flight",
    "get_airframe",
    "get_serial_ports",
    "plan_airframe",
    "serial_protocols",
    "set_airframe",
    "set_serial_port",
]
