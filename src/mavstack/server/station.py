"""The station: a connection to vehicles whose links change while it runs, for any number of clients.

    async with Station(folder="flights") as station:
        await station.sources.add("udpin://0.0.0.0:14550")

`Connection` and `Vehicle` do all the work. The station keeps what several clients share: sources, tasks,
recordings and the latest messages. It requests the telemetry that user interfaces show from each vehicle
that it finds.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import AsyncExitStack
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError
from mavstack.security.observer_requests import ObserverRequests
from mavstack.server.calibrations import Calibrations
from mavstack.server.client_shares import ClientShares
from mavstack.server.firmware import StationFlasher
from mavstack.server.generator.runner import GeneratorRunner
from mavstack.server.maps import StationMaps
from mavstack.server.observer_lane import ObserverLane
from mavstack.server.packet_hub import PacketHub
from mavstack.server.recordings import Recordings
from mavstack.server.shared_reads import SharedReads
from mavstack.server.sources import Sources
from mavstack.server.swarms import StationSwarm
from mavstack.server.tasks import Tasks
from mavstack.server.video.recordings import VideoRecordings
from mavstack.server.worlds import Worlds
from mavstack.vehicle import Connection, VehicleFound, VehicleRebooted
from mavstack.vehicle.firmware.ardupilot import ArduPilot
from mavstack.vehicle.firmware.msp import MspFirmware

if TYPE_CHECKING:
    from collections.abc import Mapping
    from os import PathLike
    from typing import Self

    from mavstack.dialects import Message
    from mavstack.router.control.client import ControlClient
    from mavstack.server.video.gateway import VideoGateway
    from mavstack.vehicle import Vehicle

logger = logging.getLogger("mavstack.server")

#: The rates of the messages that user interfaces show, in hertz.
TELEMETRY_RATES: Final[Mapping[type[Message], float]] = MappingProxyType(
    {
        common.Attitude: 10.0,
        common.GlobalPositionInt: 5.0,
        common.VfrHud: 5.0,
        common.GpsRawInt: 2.0,
        common.SysStatus: 1.0,
        common.BatteryStatus: 1.0,
        common.ExtendedSysState: 1.0,
        common.MissionCurrent: 1.0,
        common.RcChannels: 2.0,
        common.Vibration: 1.0,
    }
)
#: Rates of further messages of ArduPilot for user interfaces, in hertz; PX4 sends its wind unasked.
ARDUPILOT_RATES: Final[Mapping[type[Message], float]] = MappingProxyType(
    {common.FenceStatus: 1.0, ardupilotmega.Wind: 1.0}
)
#: The rate of the message that reports the health of the estimator, in hertz.
ESTIMATOR_RATE: Final = 1.0


class Station:
    """A connection, and what its clients share; an async context manager.

    Args:
        connection: The connection, not open; None: one with the address of a ground station.
        folder: The folder of recordings and logs; None: there are none.
        network_only: Clients may open links of the network and serial ports only.
        telemetry: Request telemetry from each vehicle.
        router: The client of a router that runs beside the station; None: there is none.
        programs: Firmware programs by name, which administrators may start in simulated worlds.
        maps: The folder of maps; None: there are none.
    """

    def __init__(
        self,
        connection: Connection | None = None,
        *,
        folder: str | PathLike[str] | None = None,
        network_only: bool = False,
        telemetry: bool = True,
        router: ControlClient | None = None,
        programs: Mapping[str, str] = MappingProxyType({}),
        maps: str | PathLike[str] | None = None,
    ) -> None:
        self.connection = Connection() if connection is None else connection
        self.sources = Sources(self.connection, network_only=network_only)
        self.flasher = StationFlasher(self.sources)
        self.worlds = Worlds(self.sources, programs)
        self.packets = PacketHub(self.connection)
        self.recordings = Recordings(self.connection, folder)
        self.videos = VideoRecordings(self.video, folder)
        self.maps = StationMaps(maps)
        self.calibrations = Calibrations()
        self.swarm = StationSwarm(self.connection)
        self.tasks = Tasks()
        self.generator = GeneratorRunner()
        #: Limits the requests of all observing clients together.
        self.observers = ObserverRequests()
        self.observer_lane = ObserverLane()
        #: Limits the answers to observing clients per turn of the event loop.
        self.answer_lane = ObserverLane(width=1)
        self.reads = SharedReads(self.connection.now)
        #: Counts the WebSockets and streams of all clients.
        self.shares = ClientShares()
        self.router = router
        self._video: VideoGateway | None = None
        self._requests_telemetry = telemetry
        self._requests: dict[int, asyncio.Task[None]] = {}
        self._closing = AsyncExitStack()

    def vehicle(self, system: int) -> Vehicle:
        """Return a vehicle; raises `RefusedError` if none with that system id was found."""
        vehicle = self.connection.vehicles.get(system)
        if vehicle is None:
            known = ", ".join(map(str, self.connection.vehicles)) or "none"
            raise RefusedError(404, f"no vehicle with system id {system} was found; known: {known}")
        return vehicle

    @property
    def video_viewers(self) -> int:
        """Number of viewers of cameras."""
        return 0 if self._video is None else self._video.viewers

    def video(self) -> VideoGateway:
        """Return the viewers of cameras; raises `MissingExtraError` without the extra `video`."""
        if self._video is None:
            from mavstack.server.video.gateway import VideoGateway

            self._video = VideoGateway()
            self._closing.push_async_callback(self._video.close)
            self._closing.push_async_callback(self.videos.close)
        return self._video

    async def open(self) -> Self:
        """Open the connection, and request telemetry from the vehicles that it finds."""
        async with AsyncExitStack() as steps:  # the last step runs first
            await steps.enter_async_context(self.connection)
            steps.callback(self.packets.close)
            self.packets.open()
            steps.push_async_callback(self.recordings.close)
            steps.push_async_callback(self.sources.close_rows)
            steps.push_async_callback(self.worlds.close)
            steps.push_async_callback(self.swarm.close)
            steps.push_async_callback(self.tasks.close)
            if self._requests_telemetry:
                follower = asyncio.get_running_loop().create_task(self._follow_vehicles())
                steps.push_async_callback(self._stop_requests, follower)
            self._closing = steps.pop_all()
        return self

    async def close(self) -> None:
        """Cancel tasks, end recordings, and close the connection. Idempotent."""
        await self._closing.aclose()

    async def _follow_vehicles(self) -> None:
        async with self.connection.events(VehicleFound, VehicleRebooted) as events:
            async for event in events:
                vehicle = event.vehicle
                request = self._requests.get(vehicle.system)
                if request is None or request.done():
                    task = asyncio.get_running_loop().create_task(_request_telemetry(vehicle))
                    self._requests[vehicle.system] = task

    async def _stop_requests(self, follower: asyncio.Task[None]) -> None:
        tasks = [follower, *self._requests.values()]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(self, *_: object) -> None:
        await self.close()


async def _request_equipment(vehicle: Vehicle) -> None:
    """Request the parameters that tell which equipment a flight controller has, for its capabilities."""
    for names in vehicle.firmware.EQUIPMENT_PARAMETERS.values():
        for name in names:
            try:
                await vehicle.params.get(name)
            except MavstackError as error:
                logger.info("%s", error)


def telemetry_rates(vehicle: Vehicle) -> dict[type[Message], float]:
    """Return the rates of the messages that user interfaces show of a vehicle, in hertz."""
    rates = dict(TELEMETRY_RATES)
    if isinstance(vehicle.firmware, ArduPilot):
        rates |= ARDUPILOT_RATES
    if not isinstance(vehicle.firmware, MspFirmware):
        rates[vehicle.firmware.ESTIMATOR_MESSAGE] = ESTIMATOR_RATE
    return rates


async def _request_telemetry(vehicle: Vehicle) -> None:
    """Request what user interfaces show; a vehicle that does not answer goes on without it."""
    try:
        await vehicle.get_version()
    except MavstackError as error:
        logger.info("%s", error)
    if isinstance(vehicle.firmware, MspFirmware):
        await _request_equipment(vehicle)
    for message, rate in telemetry_rates(vehicle).items():
        try:
            await vehicle.telemetry.ensure(message, rate)
        except MavstackError as error:
            logger.info("%s", error)
    await vehicle.telemetry.request_home()
