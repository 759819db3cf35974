"""The serial ports of a remote autopilot: `component.serial`, by SERIAL_CONTROL.

    async with component.serial.open("gps1") as port:
        port.write(bytes.fromhex("b562 0a04 0000 0e34"))
        async for data in port: ...

Nothing is acknowledged: what a link loses is lost. Leaving the block releases the port. PX4 offers its shell
alone, ArduPilot its GPS receivers, telemetry and other serial ports.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.node.api_object import ReadOnly
from mavstack.services.serial_control import ShellClient, ShellOutput, ShellReleased

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.node.clients import ComponentClients
    from mavstack.node.host import NodeHost

#: Maximum number of chunks of output that are queued until the program reads them.
OUTPUT_QUEUE: Final = 100_000
#: Seconds between two requests for the received bytes of a port.
DEFAULT_POLL: Final = 0.05
MAX_BAUD_RATE: Final = 10_000_000


def port_names() -> list[str]:
    """Return the names of ports: "gps1", "telem1", "shell", "serial0" and others."""
    return [device.name.removeprefix("DEV_").lower() for device in common.SerialControlDev]


class SerialPorts(ReadOnly):
    """The serial ports of an autopilot (SERIAL_CONTROL)."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients

    def open(
        self, device: str | int, *, baudrate: int = 0, exclusive: bool = True, poll: float = DEFAULT_POLL
    ) -> SerialPort:
        """Return a context manager during which a port is connected to this program.

        Args:
            device: The name of the port, such as "gps1" or "telem2", or a SERIAL_CONTROL_DEV.
            baudrate: The baud rate; 0 leaves it unchanged.
            exclusive: The autopilot does not use the port meanwhile, so that no byte goes astray.
            poll: Seconds between two requests for the bytes of the port.

        Returns:
            The port.

        Raises:
            InvalidArgumentError: There is no such port, or a value is out of range.
        """
        if not 0 <= baudrate <= MAX_BAUD_RATE:
            raise InvalidArgumentError(f"baudrate must be from 0 to {MAX_BAUD_RATE}, got {baudrate}")
        if not 0.001 <= poll <= 10:
            raise InvalidArgumentError(f"poll must be from 0.001 to 10 seconds, got {poll}")
        host = self._clients.host
        client = ShellClient(
            host.address,
            self._clients.address,
            device_number(device),
            baudrate=baudrate,
            exclusive=exclusive,
            poll=poll,
        )
        return SerialPort(host, client, "writing to a serial port of")


def device_number(device: str | int) -> int:
    """Return the SERIAL_CONTROL_DEV of a name or number.

    Raises:
        InvalidArgumentError: There is no such port.
    """
    names = dict(zip(port_names(), common.SerialControlDev, strict=True))
    number = names.get(device.lower()) if isinstance(device, str) else device
    if number is None or not 0 <= number <= 255:
        raise InvalidArgumentError(f"no serial port is named {device!r}; there are {', '.join(names)}")
    return int(number)


class SerialPort(ReadOnly):
    """A serial port: write bytes to it, and iterate over its bytes; an async context manager."""

    def __init__(self, host: NodeHost, client: ShellClient, description: str) -> None:
        self._host, self._client, self._description = host, client, description
        self._output = host.events(ShellOutput, of=client, queue=OUTPUT_QUEUE)

    @property
    def waiting(self) -> int:
        """The number of bytes that wait until the link has room for them."""
        return self._client.waiting

    def write(self, data: bytes) -> None:
        """Send bytes to the port.

        Args:
            data: The bytes.

        Raises:
            InvalidArgumentError: Too many bytes wait to be sent.
            SystemIdConflictError: Several vehicles use its system id, and none was chosen.
        """
        self._refuse_conflict()
        self._client.write(data, self._host.now())
        self._host.wake(self._client)

    def _refuse_conflict(self) -> None:
        if error := self._host.refusal_of(self._client.target, self._description):
            raise error

    async def __aenter__(self) -> Self:
        self._refuse_conflict()
        self._host.serve(self._client)
        self._client.open(self._host.now())
        self._host.wake(self._client)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._host.is_open:
                await self._release()
        finally:
            self._output.close()
            self._host.remove(self._client)

    async def _release(self) -> None:
        async with self._host.events(ShellReleased, of=self._client, queue=1) as released:
            self._client.close(self._host.now())
            self._host.wake(self._client)
            await anext(released, None)

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> bytes:
        data: bytes = (await anext(self._output)).data
        return data
