"""A bus of python-can over MAVLink: `can.Bus(interface="mavlink", channel=URL, bus=1)`.

python-can finds it by the entry point `can.interface`, so that its tools (`python -m can.logger -i mavlink`)
and other programs reach the CAN bus of a vehicle through its telemetry link.
"""

from __future__ import annotations

import asyncio
from queue import Empty, Full, Queue
from time import time
from typing import TYPE_CHECKING, Any, Final

import can

from mavstack.errors import MavstackError
from mavstack.node.blocking_portal import BlockingPortal
from mavstack.services.can import CanFrame
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from collections.abc import Coroutine, Iterable

#: Maximum number of frames that wait for `recv`; further frames are dropped and counted.
MAX_WAITING: Final = 50_000
DEFAULT_TIMEOUT: Final = 10.0


class MavlinkBus(can.BusABC):
    """A CAN bus of an autopilot.

    Args:
        channel: The URL of the link, such as "udpin://127.0.0.1:14550"; several are separated by commas.
        bus: The number of the bus, from 1.
        system: The system id of the vehicle; None: the first one.
        timeout: Seconds to wait for the vehicle.
        dronecan_types: Forward only frames of these DroneCAN data types; None: all.
        can_filters: The filters of python-can, applied here.
        kwargs: Further options of python-can.

    Raises:
        CanInitializationError: The link cannot be opened, no vehicle is there, or it forwards no such bus.
    """

    def __init__(
        self,
        channel: str,
        bus: int = 1,
        *,
        system: int | None = None,
        timeout: float = DEFAULT_TIMEOUT,
        dronecan_types: Iterable[int] | None = None,
        can_filters: can.typechecking.CanFilters | None = None,
        **kwargs: Any,  # noqa: ANN401 (those of python-can)
    ) -> None:
        self.channel_info = f"CAN bus {bus} by MAVLink, {channel}"
        self._received: Queue[can.Message] = Queue(MAX_WAITING)
        #: Frames that were dropped because `recv` was not called in time.
        self.dropped = 0
        self._channel = channel
        self._portal = BlockingPortal()
        try:
            self._run(self._open(int(bus), system, timeout, list(dronecan_types or ())))
        except BaseException:
            self._portal.close()
            raise
        super().__init__(channel, can_filters=can_filters, **kwargs)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send a frame; nothing acknowledges it.

        Args:
            msg: The frame.
            timeout: Not used: a frame is never queued.

        Raises:
            CanOperationError: The bus is closed, or the frame is malformed.
        """
        frame = CanFrame(
            msg.arbitration_id,
            bytes(msg.data),
            msg.is_extended_id,
            msg.is_remote_frame,
            msg.is_error_frame,
            msg.is_fd,
        )
        try:
            self._portal.call(lambda: self._bus.send(frame))
        except MavstackError as error:
            raise can.CanOperationError(str(error)) from None

    def shutdown(self) -> None:
        """End the forwarding, and close the link. Idempotent."""
        if not self._portal.closed:
            self._run(self._close())
            self._portal.close()
        super().shutdown()

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        try:
            if timeout is not None and timeout <= 0:
                return self._received.get_nowait(), False
            return self._received.get(timeout=timeout), False
        except Empty:
            return None, False

    def _run(self, work: Coroutine[Any, Any, None]) -> None:
        try:
            self._portal.wait(work)
        except MavstackError as error:
            raise can.CanInitializationError(str(error)) from None

    async def _open(self, number: int, system: int | None, wait: float, types: list[int]) -> None:
        self._connection = connect(*self._channel.split(","))
        await self._connection.open()
        try:
            vehicle = await self._connection.wait_for_vehicle(system, timeout=wait)
            self._bus = vehicle.component.can.open(number)
            await self._bus.__aenter__()
        except BaseException:
            await self._connection.close()
            raise
        if types:
            self._bus.set_filter(types)
        self._reader = asyncio.get_running_loop().create_task(self._read())

    async def _close(self) -> None:
        await self._bus.__aexit__(None, None, None)
        self._reader.cancel()
        await asyncio.gather(self._reader, return_exceptions=True)
        await self._connection.close()

    async def _read(self) -> None:
        async for frame in self._bus:
            message = can.Message(
                timestamp=time(),
                arbitration_id=frame.id,
                is_extended_id=frame.extended,
                is_remote_frame=frame.remote,
                is_error_frame=frame.error,
                is_fd=frame.fd,
                channel=self._channel,
                dlc=len(frame.data),
                data=frame.data,
                is_rx=True,
            )
            try:
                self._received.put_nowait(message)
            except Full:
                self.dropped += 1
