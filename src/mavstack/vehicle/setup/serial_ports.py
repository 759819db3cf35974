"""The serial ports of a board: which protocol each has, and at which rate.

ArduPilot has two parameters for each port. PX4 names a port in the parameter of each driver (MAV_0_CONFIG,
GPS_1_CONFIG), and its rate in SER_…_BAUD. Betaflight and iNav have functions as bits (`msp_ports`). All
firmwares take a change over when they restart.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.setup.msp_ports import msp_changes, msp_functions, msp_ports
from mavstack.vehicle.setup.serial_port import SerialPort
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.vehicle import Vehicle

#: The protocols of ArduPilot's serial ports by number.
ARDUPILOT_PROTOCOLS: Final[Mapping[int, str]] = MappingProxyType(
    {
        -1: "none", 1: "MAVLink 1", 2: "MAVLink 2", 3: "FrSky D", 4: "FrSky SPort", 5: "GPS",
        7: "Alexmos gimbal", 8: "gimbal", 9: "rangefinder", 10: "FrSky SPort passthrough", 11: "lidar 360",
        13: "beacon", 14: "Volz servo", 15: "SBUS servo", 16: "ESC telemetry", 18: "optical flow",
        19: "Robotis servo", 20: "NMEA output", 21: "wind vane", 22: "SLCAN", 23: "RC input", 24: "EFI",
        28: "scripting", 30: "generator", 32: "MSP", 33: "DJI FPV", 34: "airspeed", 35: "ADS-B", 36: "AHRS",
        42: "MSP DisplayPort", 43: "MAVLink high latency", 45: "DDS",
    }
)  # fmt: skip
#: Rates in bits per second of the small values of SERIALn_BAUD; a larger value is the rate itself.
_ARDUPILOT_RATES: Final[Mapping[int, int]] = MappingProxyType(
    {
        1: 1200, 2: 2400, 4: 4800, 9: 9600, 19: 19200, 38: 38400, 57: 57600, 100: 100000, 111: 111100,
        115: 115200, 230: 230400, 256: 256000, 460: 460800, 500: 500000, 921: 921600, 1500: 1500000,
        2000: 2000000,
    }
)  # fmt: skip
#: The serial ports of PX4, by the number that the parameters of drivers hold.
_PX4_PORTS: Final[Mapping[int, str]] = MappingProxyType(
    {
        6: "URT6", 101: "TEL1", 102: "TEL2", 103: "TEL3", 104: "TEL4", 201: "GPS1", 202: "GPS2", 203: "GPS3",
        300: "RC", 401: "WIFI",
    }
)  # fmt: skip
_PX4_USER: Final = re.compile(
    r"^(MAV_\d|GPS_\d|RC_PORT|TEL_FRSKY|TEL_HOTT|TEL_BST|MSP_OSD)_CONFIG$|^\w+_CFG$"
)
_ARDUPILOT_PORT: Final = re.compile(r"^SERIAL(\d+)_PROTOCOL$")


async def get_serial_ports(vehicle: Vehicle) -> tuple[SerialPort, ...]:
    """Return the serial ports of a vehicle; its parameters are downloaded if they are not yet.

    Args:
        vehicle: The vehicle.

    Returns:
        The ports, in the order of their names.

    Raises:
        ActionUnsupported: The firmware has no such parameters.
        RemoteError: The vehicle does not answer.
    """
    _check(vehicle)
    if not vehicle.params.is_complete:
        await vehicle.params.download()
    values = {name: each.value for name, each in vehicle.params.cached.items()}
    return msp_ports(values, vehicle.identifier) if vehicle.identifier else serial_ports_of(values)


def serial_ports_of(values: Mapping[str, float]) -> tuple[SerialPort, ...]:
    """Return the serial ports that a set of parameters of ArduPilot or PX4 describes.

    Args:
        values: The values of all parameters by name.

    Returns:
        The ports.
    """
    numbers = sorted(int(found[1]) for name in values if (found := _ARDUPILOT_PORT.match(name)))
    if numbers:
        return tuple(_ardupilot_port(f"SERIAL{number}", values) for number in numbers)
    users = {name: int(value) for name, value in values.items() if _PX4_USER.match(name) and value}
    named = [name[4:-5] for name in values if name.startswith("SER_") and name.endswith("_BAUD")]
    ports = sorted({*named, *(_PX4_PORTS[number] for number in users.values() if number in _PX4_PORTS)})
    return tuple(_px4_port(port, users, values) for port in ports)


def serial_protocols(vehicle: Vehicle) -> Mapping[int, str]:
    """Return the protocols that a port of a vehicle can be set to; nothing is sent.

    Args:
        vehicle: The vehicle.

    Returns:
        Their names by number; for Betaflight and iNav the functions by bit, which add up; empty for PX4,
        whose drivers select their ports.
    """
    if vehicle.identifier:
        return msp_functions(vehicle.identifier)
    return (
        ARDUPILOT_PROTOCOLS
        if vehicle.autopilot == common.MavAutopilot.ARDUPILOTMEGA
        else MappingProxyType({})
    )


async def set_serial_port(
    vehicle: Vehicle, name: str, protocol: int | None = None, baud: int | None = None
) -> SerialPort:
    """Set protocol and rate of a serial port, or the rate alone of one of PX4; it needs a restart.

    Args:
        vehicle: The vehicle.
        name: The name of the port: SERIAL1, TEL1, UART1.
        protocol: The number of the protocol of ArduPilot; the functions of Betaflight and iNav as bits; None:
            as it is.
        baud: The rate in bits per second; None: as it is.

    Returns:
        The port as it is now.

    Raises:
        InvalidArgumentError: There is no such port, protocol or rate.
        ActionUnsupported: The firmware has no such parameters.
        RemoteError: The vehicle refuses a value, is armed, or does not answer.
    """
    ports = {port.name: port for port in await get_serial_ports(vehicle)}
    if name not in ports:
        raise InvalidArgumentError(
            f"there is no serial port {name}; the vehicle has {', '.join(ports) or 'none'}"
        )
    if vehicle.identifier:
        changes = msp_changes(ports, name, vehicle.identifier, protocol, baud)
    else:
        changes = _changes(name, protocol, baud)
    for parameter, value in changes.items():
        await with_status_texts(vehicle, vehicle.params.set(parameter, value))
    await vehicle.params.commit()
    return {port.name: port for port in await get_serial_ports(vehicle)}[name]


def _changes(name: str, protocol: int | None, baud: int | None) -> dict[str, int]:
    """Return the parameters to set."""
    if not name.startswith("SERIAL"):
        if protocol is not None:
            raise InvalidArgumentError(
                "PX4 selects the port in the parameter of each driver, such as MAV_0_CONFIG"
            )
        return {} if baud is None else {f"SER_{name}_BAUD": _checked_baud(baud)}
    changes = {}
    if protocol is not None:
        if protocol not in ARDUPILOT_PROTOCOLS:
            raise InvalidArgumentError(
                f"{protocol} is not the number of a protocol of ArduPilot's serial ports"
            )
        changes[f"{name}_PROTOCOL"] = protocol
    if baud is not None:
        numbers = {rate: number for number, rate in _ARDUPILOT_RATES.items()}
        changes[f"{name}_BAUD"] = numbers.get(_checked_baud(baud), baud)
    return changes


def _checked_baud(baud: int) -> int:
    if baud and not 1200 <= baud <= 12_500_000:
        raise InvalidArgumentError(f"a rate must be 1200 to 12500000 bits per second, got {baud}")
    return baud


def _ardupilot_port(name: str, values: Mapping[str, float]) -> SerialPort:
    parameters = (f"{name}_PROTOCOL", f"{name}_BAUD")
    protocol, rate = int(values[parameters[0]]), int(values.get(parameters[1], 0))
    words = ARDUPILOT_PROTOCOLS.get(protocol, f"protocol {protocol}")
    return SerialPort(name, words, protocol, _ARDUPILOT_RATES.get(rate, rate), parameters)


def _px4_port(name: str, users: Mapping[str, int], values: Mapping[str, float]) -> SerialPort:
    drivers = tuple(user for user, number in users.items() if _PX4_PORTS.get(number) == name)
    rate = f"SER_{name}_BAUD"
    words = ", ".join(driver.removesuffix("_CONFIG").removesuffix("_CFG") for driver in drivers)
    return SerialPort(name, words or "none", None, int(values.get(rate, 0)), (rate, *drivers))


def _check(vehicle: Vehicle) -> None:
    if not vehicle.identifier and vehicle.autopilot not in (
        common.MavAutopilot.ARDUPILOTMEGA,
        common.MavAutopilot.PX4,
    ):
        raise firmware_of(vehicle).unsupported(
            "show its serial ports", "its firmware has no parameters for that"
        )
