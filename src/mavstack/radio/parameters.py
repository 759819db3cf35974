"""The parameters of SiK radios, S0 to S15: numbers, units, values, and which must be equal at both ends.

A radio that hops over other frequencies, at another rate or in other windows than its peer never hears it.
The parameters that decide about these are `shared`; the others belong to one radio. Most parameters take
effect at the next restart. Sources: `parameters.c` and `main.c` of the firmware, and the page about SiK
radios of ArduPilot's wiki.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The baud rates by value of SERIAL_SPEED.
BAUD_RATES: Final[Mapping[int, int]] = MappingProxyType(
    {
        1: 1200,
        2: 2400,
        4: 4800,
        9: 9600,
        19: 19200,
        38: 38400,
        57: 57600,
        115: 115200,
        230: 230400,
        460: 460800,
        1000: 1000000,
    }
)
#: Largest value that the firmware can store.
MAX_VALUE: Final = 0xFFFFFFFF


@dataclass(frozen=True, slots=True)
class RadioParameter:
    """One parameter of SiK radios.

    Attributes:
        number: Number n of the register, as in ATSn.
        name: Name, as ATI5 lists it.
        summary: Meaning in a few words.
        minimum: Smallest value.
        maximum: Largest value.
        unit: Unit of the value, "" if there is none.
        allowed: The only values, where not all between minimum and maximum are.
        zero: Meaning of the value 0 where 0 is below the minimum, "" if 0 is no value.
        shared: True if both ends must have the same value.
        writable: False for the version of the format.
    """

    number: int
    name: str
    summary: str
    minimum: int
    maximum: int
    unit: str = ""
    allowed: tuple[int, ...] = ()
    zero: str = ""
    shared: bool = False
    writable: bool = True

    @property
    def values_text(self) -> str:
        """The valid values in words."""
        if self.allowed:
            return ", ".join(map(str, self.allowed))
        text = f"{self.minimum} to {self.maximum}" + (f" {self.unit}" if self.unit else "")
        return f"{text}, or 0 ({self.zero})" if self.zero else text

    def check(self, value: int) -> None:
        """Raise an error if the parameter cannot have a value.

        Args:
            value: The value, in the parameter's unit.

        Raises:
            InvalidArgumentError: The value is not valid, or the parameter cannot be set.
        """
        if not self.writable:
            raise InvalidArgumentError(f"{self.name} cannot be set: the firmware sets it")
        if self.allowed:
            valid = value in self.allowed
        else:
            valid = self.minimum <= value <= self.maximum or bool(self.zero and value == 0)
        if not valid:
            raise InvalidArgumentError(f"{self.name} cannot be {value}: the values are {self.values_text}")


_FREQUENCY: Final = (414_000, 935_000)
#: The parameters of all SiK firmwares by name. Newer firmwares have more, which ATI5 lists.
PARAMETERS: Final[Mapping[str, RadioParameter]] = MappingProxyType(
    {
        each.name: each
        for each in (
            RadioParameter(0, "FORMAT", "version of the stored parameters", 0, MAX_VALUE, writable=False),
            RadioParameter(
                1,
                "SERIAL_SPEED",
                "rate of the serial port: kilobaud, rounded down",
                1,
                1000,
                allowed=tuple(BAUD_RATES),
            ),
            RadioParameter(
                2,
                "AIR_SPEED",
                "rate over the air; the radio takes the next higher one that it has",
                2,
                1000,
                "kbit/s",
                shared=True,
            ),
            RadioParameter(
                3, "NETID", "number of the network: selects the hopping sequence", 0, 65535, shared=True
            ),
            RadioParameter(4, "TXPOWER", "transmit power", 0, 30, "dBm"),
            RadioParameter(
                5, "ECC", "error correction by a Golay code, which halves the bandwidth", 0, 1, shared=True
            ),
            RadioParameter(
                6, "MAVLINK", "0: raw bytes, 1: whole packets and RADIO_STATUS, 2: with low latency", 0, 2
            ),
            RadioParameter(7, "OPPRESEND", "resend a packet when there is time", 0, 1),
            RadioParameter(
                8, "MIN_FREQ", "lowest frequency", *_FREQUENCY, "kHz", zero="that of the board", shared=True
            ),
            RadioParameter(
                9, "MAX_FREQ", "highest frequency", *_FREQUENCY, "kHz", zero="that of the board", shared=True
            ),
            RadioParameter(
                10, "NUM_CHANNELS", "number of hopping channels", 1, 50, zero="that of the board", shared=True
            ),
            RadioParameter(11, "DUTY_CYCLE", "share of time in which the radio may transmit", 0, 100, "%"),
            RadioParameter(
                12, "LBT_RSSI", "listen before talk: busy above this", 25, 220, zero="off", shared=True
            ),
            RadioParameter(13, "MANCHESTER", "Manchester coding over the air", 0, 1, shared=True),
            RadioParameter(14, "RTSCTS", "flow control of the serial port", 0, 1),
            RadioParameter(
                15,
                "MAX_WINDOW",
                "longest window of one transmitter; many firmwares allow 131 at most",
                20,
                400,
                "ms",
                shared=True,
            ),
        )
    }
)
#: Names of the parameters that both ends must share.
SHARED: Final = frozenset(each.name for each in PARAMETERS.values() if each.shared)


def check_value(name: str, value: int) -> None:
    """Raise an error if a parameter cannot have a value; the radio itself decides about unknown ones.

    Args:
        name: Name of the parameter in capital letters.
        value: The value.

    Raises:
        InvalidArgumentError: The value is not valid, or the parameter cannot be set.
    """
    if name in PARAMETERS:
        PARAMETERS[name].check(value)
    elif not 0 <= value <= MAX_VALUE:
        raise InvalidArgumentError(f"{name} cannot be {value}: the values are 0 to {MAX_VALUE}")
