"""One radio of a pair by its commands: identity, parameters, signal; near, or remote over the air."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError, InvalidStateError, LinkError, RadioError
from mavstack.radio.parameters import MAX_VALUE, PARAMETERS, check_value
from mavstack.radio.replies import (
    RssiReport,
    StoredParameter,
    parse_number,
    parse_parameters,
    parse_rssi,
    parse_timing,
)
from mavstack.radio.session import AtCommand, Reply

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Iterable, Mapping

    from mavstack.radio.modem import SikModem

#: The bands of boards in MHz, by their reply to ATI3.
BANDS: Final[Mapping[int, int]] = MappingProxyType({0x43: 433, 0x47: 470, 0x86: 868, 0x91: 915})


@dataclass(frozen=True, slots=True)
class RadioIdentity:
    """The identity of a radio.

    Attributes:
        banner: Firmware and board, such as "SiK 2.2 on HM-TRP".
        board: Number of the board type, or None.
        band: Frequency band in MHz, or None.
        bootloader: Version of the boot loader, or None.
    """

    banner: str
    board: int | None
    band: int | None
    bootloader: int | None


class SikRadio:
    """One radio of a pair.

    Args:
        modem: The open modem.
        remote: True for the radio at the other end.
    """

    def __init__(self, modem: SikModem, *, remote: bool = False) -> None:
        self._modem = modem
        self.remote = remote

    @property
    def name(self) -> str:
        """The radio in words: "local" or "remote"."""
        return "remote" if self.remote else "local"

    async def run(self, text: str, reply: Reply, *, attempts: int = 3) -> tuple[str, ...]:
        """Run a command.

        Args:
            text: The command without AT or RT, such as `I5`.
            reply: The kind of its reply.
            attempts: How often it is sent in all if no reply comes.

        Returns:
            The lines of the reply.

        Raises:
            RadioError: The radio does not answer, or refuses the command.
        """
        prefix = "RT" if self.remote else "AT"
        return await self._modem.run(AtCommand(f"{prefix}{text}", reply, attempts))

    async def get_identity(self) -> RadioIdentity:
        """Return firmware, board and band.

        Raises:
            RadioError: The radio does not answer.
        """
        banner = (await self.run("I", Reply.LINE))[0]
        board, frequency, bootloader = [await self._number(f"I{number}") for number in (2, 3, 4)]
        return RadioIdentity(banner, board, BANDS.get(frequency or 0), bootloader)

    async def get_parameters(self) -> dict[str, StoredParameter]:
        """Return all parameters by name.

        The reply of a remote radio is cut to one packet; the parameters that it lacks are read one by one.

        Raises:
            RadioError: The radio does not answer.
        """
        found = parse_parameters(await self.run("I5", Reply.LINES))
        for name, parameter in PARAMETERS.items():
            if name not in found:
                with_value = await self._number(f"S{parameter.number}?")
                if with_value is not None:
                    found[name] = StoredParameter(parameter.number, with_value)
        return dict(sorted(found.items(), key=lambda item: item[1].number))

    async def get_timing(self) -> dict[str, int]:
        """Return the timing of transmissions by name, in 16 µs and bytes; empty if it has no such report.

        Raises:
            RadioError: The radio does not answer.
        """
        try:
            return parse_timing(await self.run("I6", Reply.LINES))
        except RadioError as error:
            if error.refused:
                return {}
            raise

    async def get_factory_values(self) -> dict[str, int]:
        """Return the values of the factory by name; the present ones are set again, and nothing is stored.

        Raises:
            RadioError: The radio does not answer.
        """
        present = await self.get_parameters()
        await self.reset()
        factory = await self.get_parameters()
        for name, each in present.items():
            if name in factory and factory[name].value != each.value:
                await self.set_value(each.number, each.value)
        return {name: each.value for name, each in factory.items() if name != "FORMAT"}

    async def get_value(self, number: int) -> int:
        """Return the value of a parameter.

        Args:
            number: Number of its register.

        Raises:
            RadioError: The radio does not answer, or has no such parameter.
        """
        line = (await self.run(f"S{number}?", Reply.LINE))[-1]
        value = parse_number(line)
        if value is None:
            raise RadioError(f"reading S{number} of the {self.name} radio failed: it answers {line!r}")
        return value

    async def set_value(self, number: int, value: int) -> None:
        """Set a parameter until the next restart, without storing it.

        Args:
            number: Number of its register.
            value: The value.

        Raises:
            RadioError: The radio does not answer, or refuses the value.
        """
        if not 0 <= value <= MAX_VALUE:
            raise InvalidArgumentError(f"S{number} cannot be {value}: the values are 0 to {MAX_VALUE}")
        await self.run(f"S{number}={value}", Reply.RESULT)

    async def store(self) -> None:
        """Write the present parameters to the EEPROM.

        Raises:
            RadioError: The radio does not answer, or cannot write.
        """
        await self.run("&W", Reply.RESULT)

    async def restart(self, *, baud: int | None = None) -> None:
        """Restart with the stored parameters; the restart of a remote radio is not confirmed.

        Args:
            baud: Baud rate of a local radio's serial port after the restart; None for the present one.

        Raises:
            RadioError: The radio does not answer.
        """
        if self.remote:
            await self.run("Z", Reply.NONE, attempts=1)
        else:
            await self._modem.restart(baud=baud)

    async def reset(self) -> None:
        """Set all parameters to the factory defaults, without storing them.

        Raises:
            RadioError: The radio does not answer.
        """
        await self.run("&F", Reply.RESULT)

    async def get_rssi(self) -> RssiReport:
        """Return a report about the link.

        Raises:
            RadioError: The radio does not answer, or has no such report.
        """
        line = (await self.run("I7", Reply.LINE))[-1]
        report = parse_rssi(line)
        if report is None:
            raise RadioError(f"reading the signal of the {self.name} radio failed: it answers {line!r}")
        return report

    async def stream_rssi(self) -> AsyncGenerator[RssiReport]:
        """Yield the reports about the link that the radio prints by itself (AT&T=RSSI), about one a second.

        A radio that prints none is asked for them (ATI7). Reports are turned off when the iterator is closed.

        Raises:
            InvalidStateError: The radio is the remote one, whose reports go to its own serial port.
            RadioError: The radio does not answer, or has no such report.
        """
        if self.remote:
            raise InvalidStateError("the remote radio prints reports on its own serial port: use get_rssi()")
        try:
            for command in ("&T", "&T=RSSI"):  # &T=RSSI alone would turn reports off if they are on
                await self._run_if_known(command)
            while True:
                for report in await self._modem.wait_for_reports() or [await self.get_rssi()]:
                    yield report
        finally:
            with suppress(RadioError, LinkError):
                await self.run("&T", Reply.NONE)

    async def _run_if_known(self, text: str) -> None:
        try:
            await self.run(text, Reply.NONE)
        except RadioError as error:
            if not error.refused:
                raise

    async def _number(self, text: str) -> int | None:
        try:
            return parse_number((await self.run(text, Reply.LINE))[-1])
        except RadioError as error:
            if error.refused:
                return None  # older firmware does not have this command
            raise


def require_known(names: Iterable[str], known: Mapping[str, StoredParameter], radio: SikRadio) -> None:
    """Raise an error if the radio lacks a parameter.

    Args:
        names: Names of parameters.
        known: The parameters of the radio.
        radio: The radio.

    Raises:
        InvalidArgumentError: The radio has no such parameter; the text has the nearest name.
    """
    from difflib import get_close_matches

    for name in names:
        if name not in known:
            near = get_close_matches(name, known, n=1)
            hint = f"did you mean {near[0]}?" if near else f"it has {', '.join(known)}"
            raise InvalidArgumentError(f"the {radio.name} radio has no parameter {name}; {hint}")


def check_values(values: Mapping[str, int]) -> None:
    """Raise an error if a parameter cannot have its value.

    Raises:
        InvalidArgumentError: A value is not valid.
    """
    for name, value in values.items():
        check_value(name, value)
