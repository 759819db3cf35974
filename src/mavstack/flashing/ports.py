"""The serial ports of this machine, and the boards that their USB ids name."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from serial.tools.list_ports_common import ListPortInfo

#: Known boards by USB vendor and product id; True marks a bootloader.
_KNOWN: Final[Mapping[tuple[int, int], tuple[str, bool]]] = MappingProxyType(
    {
        (0x26AC, 0x0010): ("PX4 FMU", False),
        (0x26AC, 0x0011): ("PX4 bootloader", True),
        (0x26AC, 0x0032): ("PX4 FMUv5", False),
        (0x3162, 0x004B): ("Pixhawk 4", False),
        (0x1209, 0x5740): ("ArduPilot", False),
        (0x1209, 0x5741): ("ArduPilot", False),
        (0x2DAE, 0x1011): ("CubeBlack", False),
        (0x2DAE, 0x1016): ("CubeOrange", False),
        (0x2DAE, 0x1058): ("CubeOrangePlus", False),
        (0x0483, 0x5740): ("Betaflight or iNav", False),
        (0x0483, 0xDF11): ("STM32 in its ROM (DFU)", True),
        (0x0403, 0x6015): ("SiK radio, or another device with an FTDI chip", False),
        (0x10C4, 0xEA60): ("SiK radio, or another device with a CP210x chip", False),
    }
)
#: USB vendor ids of manufacturers of boards for PX4 and ArduPilot.
_VENDORS: Final[Mapping[int, str]] = MappingProxyType(
    {0x26AC: "PX4", 0x3162: "Holybro", 0x3185: "Auterion, Holybro or ARK", 0x2DAE: "CubePilot"}
)
_MODEM_MANAGERS: Final = ("/usr/sbin/ModemManager", "/usr/bin/ModemManager")


@dataclass(frozen=True, slots=True)
class PortInfo:
    """A serial port.

    Attributes:
        device: Its path or name.
        board: The board behind it, by its USB ids; empty if they are not known.
        description: The description that the device has.
        usb: The USB ids as "26ac:0011"; empty for another kind of port.
        serial: The serial number of the device; empty if it has none.
        in_bootloader: True if the USB ids are those of a bootloader.
    """

    device: str
    board: str = ""
    description: str = ""
    usb: str = ""
    serial: str = ""
    in_bootloader: bool = False


def list_ports() -> list[PortInfo]:
    """Return the serial ports of this machine.

    Raises:
        MissingExtraError: pyserial is not installed.
    """
    try:
        from serial.tools.list_ports import comports
    except ImportError as error:
        raise MissingExtraError("the list of serial ports", "serial") from error
    return describe(comports())


def describe(ports: Iterable[ListPortInfo]) -> list[PortInfo]:
    """Return ports of pyserial with their boards, in the order of their names."""
    return [_described(port) for port in sorted(ports, key=lambda port: port.device)]


def _described(port: ListPortInfo) -> PortInfo:
    vendor, product = port.vid, port.pid
    text = port.description or ""
    if vendor is None or product is None:
        return PortInfo(port.device, description="" if text == "n/a" else text)
    name, in_bootloader = _KNOWN.get((vendor, product), (_VENDORS.get(vendor, ""), False))
    in_bootloader = in_bootloader or (vendor in _VENDORS and "BL" in text)
    usb = f"{vendor:04x}:{product:04x}"
    return PortInfo(port.device, name, text, usb, port.serial_number or "", in_bootloader)


def has_modem_manager() -> bool:
    """Return whether ModemManager is installed, which opens new ports and so disturbs bootloaders."""
    return any(Path(path).exists() for path in _MODEM_MANAGERS)
