"""Check lists, airframes and serial ports as JSON, for scripts and for the station."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.setup.airframe import Airframe
    from mavstack.vehicle.setup.first_flight import CheckItem
    from mavstack.vehicle.setup.serial_port import SerialPort


def check_json(item: CheckItem) -> dict[str, Any]:
    """Return an item of a check list for JSON."""
    return {"name": item.name, "state": str(item.state), "text": item.text, "remedy": item.remedy}


def airframe_json(airframe: Airframe) -> dict[str, Any]:
    """Return an airframe for JSON."""
    return {"name": airframe.name, "values": dict(airframe.values), "defined": airframe.defined}


def port_json(port: SerialPort) -> dict[str, Any]:
    """Return a serial port for JSON."""
    return {
        "name": port.name,
        "protocol": port.protocol,
        "number": port.number,
        "baud": port.baud,
        "parameters": list(port.parameters),
    }


def choices_json(names: Mapping[int, str]) -> list[dict[str, Any]]:
    """Return named numbers for JSON."""
    return [{"number": number, "name": name} for number, name in names.items()]
