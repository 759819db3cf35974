"""The serial ports of Betaflight and iNav: each has functions as bits, and a rate for each kind of function.

A bridge offers them as parameters. A firmware resets all ports if none has MSP, and USB is the way back to a
flight controller with wrong settings. Changes that take MSP from USB or from the last port are refused here.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.msp.firmware_info import INAV
from mavstack.msp.messages.config import BAUD_RATES, INAV_BAUD_RATES, InavSerialFunction, SerialFunction
from mavstack.msp.serial_ports import PORT_IDENTIFIERS
from mavstack.vehicle.setup.serial_port import SerialPort

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_FUNCTIONS: Final = "_FUNC"
_USB: Final = "VCP"
_TELEMETRY: Final = "TELEMETRY"
#: The ends of the names of parameters with rates, by the function that uses the rate.
_RATES: Final = {"MSP": "_B_MSP", "GPS": "_B_GPS", _TELEMETRY: "_B_TLM", "BLACKBOX": "_B_BBX"}


def msp_functions(identifier: str) -> Mapping[int, str]:
    """Return the functions of serial ports.

    Args:
        identifier: The identifier of the firmware, "BTFL" or "INAV".

    Returns:
        Their names by their bits.
    """
    kind = InavSerialFunction if identifier == INAV else SerialFunction
    return MappingProxyType({int(each): str(each.name).replace("_", " ") for each in kind})


def msp_ports(values: Mapping[str, float], identifier: str) -> tuple[SerialPort, ...]:
    """Return the serial ports that a set of parameters describes.

    Args:
        values: The values of all parameters by name.
        identifier: The identifier of the firmware, "BTFL" or "INAV".

    Returns:
        The ports.
    """
    names = [name for name in PORT_IDENTIFIERS if f"{_prefix(name)}{_FUNCTIONS}" in values]
    return tuple(_port(name, values, identifier) for name in names)


def msp_changes(
    ports: Mapping[str, SerialPort], name: str, identifier: str, functions: int | None, baud: int | None
) -> dict[str, int]:
    """Return the parameters to set for a change of a port.

    Args:
        ports: The ports by name.
        name: The name of the port.
        identifier: The identifier of the firmware, "BTFL" or "INAV".
        functions: The functions as bits; None: as they are.
        baud: The rate in bits per second; None: as it is.

    Returns:
        Their values by name.

    Raises:
        InvalidArgumentError: The firmware does not have such a function or rate, or nothing could reach it.
    """
    changes = {}
    if functions is not None:
        _check_functions(ports, name, identifier, functions)
        changes[f"{_prefix(name)}{_FUNCTIONS}"] = functions
    if baud is not None:
        wanted = ports[name].number if functions is None else functions
        changes |= _rate_changes(name, identifier, int(wanted or 0), baud)
    return changes


def _check_functions(ports: Mapping[str, SerialPort], name: str, identifier: str, functions: int) -> None:
    known = sum(msp_functions(identifier))
    if functions < 0 or functions & ~known:
        raise InvalidArgumentError(f"{functions} has bits that are not functions of a serial port")
    msp = int(SerialFunction.MSP)
    others = [each for each in ports.values() if each.name != name and int(each.number or 0) & msp]
    if not functions & msp and (name == _USB or not others):
        reason = "USB needs MSP" if name == _USB else "it is the last port with MSP"
        raise InvalidArgumentError(f"{name} keeps the function MSP ({msp}): {reason}")


def _rate_changes(name: str, identifier: str, functions: int, baud: int) -> dict[str, int]:
    rates = _rates(identifier)
    if baud not in rates:
        raise InvalidArgumentError(f"a rate must be one of {', '.join(map(str, rates))}, got {baud}")
    ends = list(_rate_ends(functions, identifier))
    if not ends:
        raise InvalidArgumentError(f"the functions of {name} have no rate that can be set")
    return {f"{_prefix(name)}{end}": rates.index(baud) for end in ends}


def _port(name: str, values: Mapping[str, float], identifier: str) -> SerialPort:
    prefix = _prefix(name)
    functions = int(values[f"{prefix}{_FUNCTIONS}"])
    words = [words for bit, words in msp_functions(identifier).items() if functions & bit]
    rates = [f"{prefix}{end}" for end in _RATES.values()]
    used = [int(values.get(f"{prefix}{end}", 0)) for end in _rate_ends(functions, identifier)]
    table = _rates(identifier)
    baud = table[used[0]] if used and used[0] < len(table) else 0
    return SerialPort(name, ", ".join(words) or "none", functions, baud, (f"{prefix}{_FUNCTIONS}", *rates))


def _rate_ends(functions: int, identifier: str) -> Iterator[str]:
    """Yield the ends of the names of the rates that some functions use."""
    names = [words.split()[0] for bit, words in msp_functions(identifier).items() if functions & bit]
    yield from (_RATES[name] for name in dict.fromkeys(names) if name in _RATES)


def _rates(identifier: str) -> tuple[int, ...]:
    return INAV_BAUD_RATES if identifier == INAV else BAUD_RATES


def _prefix(name: str) -> str:
    return f"BF_{name.replace('SOFTSERIAL', 'SOFT')}"
