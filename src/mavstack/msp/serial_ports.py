"""The names of the serial ports of flight controllers, by their identifiers in MSP.

Identifiers are fixed by kind. Betaflight numbers the UARTs from 51 on since version 1.47 of its interface,
which leaves 50 to UART0; older versions and iNav number them from 0 on.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

_UARTS: Final = range(1, 11)
#: The identifiers of each port, older ones first.
PORT_IDENTIFIERS: Final[Mapping[str, tuple[int, ...]]] = MappingProxyType(
    {
        "VCP": (20,),
        "UART0": (50,),
        **{f"UART{number}": (number - 1, number + 50) for number in _UARTS},
        "LPUART1": (40,),
        "SOFTSERIAL1": (30,),
        "SOFTSERIAL2": (31,),
    }
)
#: The names of the ports by identifier.
PORT_NAMES: Final[Mapping[int, str]] = MappingProxyType(
    {each: name for name, identifiers in PORT_IDENTIFIERS.items() for each in identifiers}
)
