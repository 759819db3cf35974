"""The CAN buses of a remote autopilot: `component.can`.

    async with component.can.open(1) as bus:
        bus.send(CanFrame(0x1401557F, bytes(8)))
        async for frame in bus: ...

Leaving the block ends the forwarding. An autopilot forwards one bus to one client.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, MavstackError
from mavstack.node.api_object import ReadOnly
from mavstack.services.arguments import check_number
from mavstack.services.can import CanFrame, from_message, to_message
from mavstack.services.command import Command, CommandOperation

if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import TracebackType
    from typing import Self

    from mavstack.node.clients import ComponentClients
    from mavstack.node.subscription import Subscription

#: Seconds between two commands that renew the forwarding.
RENEWAL_INTERVAL: Final = 1.0
#: Maximum number of frames that are queued until the program reads them.
DEFAULT_FRAMES: Final = 10_000
_MAX_FILTERS: Final = 16
_MAX_BUS: Final = 255


class Can(ReadOnly):
    """The CAN buses of an autopilot (CAN_FRAME, CANFD_FRAME)."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients

    def open(self, bus: int = 1, *, queue: int = DEFAULT_FRAMES) -> CanBus:
        """Return a context manager during which a bus is forwarded (MAV_CMD_CAN_FORWARD).

        Args:
            bus: The number of the bus, from 1.
            queue: Frames that are queued while the program does not read; then the oldest is dropped.

        Returns:
            The bus. Entering it raises CommandDenied if the autopilot has no such bus, or forwards none, and
            CommandTimeout if it does not answer.

        Raises:
            InvalidTypeError: The number is not a number.
            InvalidArgumentError: The number is not from 1 to 255.
        """
        check_number("bus", bus)
        if not 1 <= bus <= _MAX_BUS:
            raise InvalidArgumentError(f"bus must be from 1 to {_MAX_BUS}, got {bus}")
        return CanBus(self._clients, int(bus), queue)


class CanBus(ReadOnly):
    """A bus that is forwarded; made by `Can.open`, an async iterator of frames."""

    def __init__(self, clients: ComponentClients, bus: int, queue: int) -> None:
        self._clients, self._bus = clients, bus
        kinds = (common.CanFrame, common.CanfdFrame)
        self._messages: Subscription[common.CanFrame | common.CanfdFrame] = clients.host.stream(
            kinds, clients.address, queue=queue, keep_all=False
        )
        self._renewal: asyncio.Task[None] | None = None

    @property
    def dropped(self) -> int:
        """Frames that were dropped because they were not read in time."""
        return self._messages.dropped

    def send(self, frame: CanFrame) -> None:
        """Send a frame to the bus; nothing acknowledges it.

        Args:
            frame: The frame.

        Raises:
            InvalidArgumentError: The identifier or the data is too long.
            InvalidStateError: The node is closed.
        """
        system, component = self._clients.address
        self._clients.host.send(to_message(frame, self._bus, system, component), self._clients.address)

    def set_filter(self, types: Iterable[int]) -> None:
        """Let the autopilot forward only frames of these DroneCAN data types (CAN_FILTER_MODIFY).

        Args:
            types: Up to 16 data types; none: all frames.

        Raises:
            InvalidArgumentError: There are more than 16, or one is out of range.
        """
        ids = sorted(set(types))
        if len(ids) > _MAX_FILTERS or any(not 0 <= number <= 0xFFFF for number in ids):
            raise InvalidArgumentError(f"a filter has up to {_MAX_FILTERS} data types from 0 to 65535")
        system, component = self._clients.address
        message = common.CanFilterModify(
            target_system=system,
            target_component=component,
            bus=self._bus,
            operation=common.CanFilterOp.REPLACE,
            num_ids=len(ids),
            ids=[*ids, *[0] * (_MAX_FILTERS - len(ids))],
        )
        self._clients.host.send(message, self._clients.address)

    async def __aenter__(self) -> Self:
        await self._forward(self._bus)
        self._renewal = asyncio.get_running_loop().create_task(self._renew())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._messages.close()
        if self._renewal is not None:
            self._renewal.cancel()
            await asyncio.gather(self._renewal, return_exceptions=True)
        if self._clients.host.is_open and kind is None:
            try:
                await self._forward(0, timeout=1.0)
            except MavstackError:  # without renewals the vehicle ends the forwarding by itself
                return

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> CanFrame:
        async for message in self._messages:
            if message.bus + 1 == self._bus:
                return from_message(message)
        raise StopAsyncIteration

    async def _renew(self) -> None:
        while True:
            await asyncio.sleep(RENEWAL_INTERVAL)
            try:
                await self._forward(self._bus, timeout=RENEWAL_INTERVAL)
            except MavstackError:
                # the command was lost, or the vehicle reboots: the next command may succeed
                continue

    async def _forward(self, number: int, *, timeout: float | None = None) -> None:
        host = self._clients.host
        command = Command.of(host.named_command(common.MavCmd.CAN_FORWARD), (float(number),), None)
        await host.run_operation(self._clients.command, CommandOperation(command, timeout=timeout))
