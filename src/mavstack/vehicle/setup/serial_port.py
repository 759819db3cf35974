"""A serial port of a board, for all firmwares."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SerialPort:
    """A serial port of a board.

    Attributes:
        name: Its name: SERIAL1, TEL1, UART1.
        protocol: The protocol, the driver or the functions in words; "none" if it is not used.
        number: The number of the protocol of ArduPilot; the functions of Betaflight and iNav as bits; None
            for PX4.
        baud: The rate in bits per second; 0: the driver decides.
        parameters: The parameters that decide it.
    """

    name: str
    protocol: str
    number: int | None
    baud: int
    parameters: tuple[str, ...]
