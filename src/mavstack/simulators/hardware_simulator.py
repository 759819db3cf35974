"""Hardware in the loop: the world of a flight controller board at a link, mostly a serial port.

The board runs by its own clock, so the simulation runs in real time: sensors at 250 Hz (PX4) or states at
50 Hz (ArduPilot), and the latest outputs of the board move the body. Lost packets are not repeated.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.dialects import Dialect, common
from mavstack.errors import InvalidArgumentError, LinkClosedError, LinkError
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, open_link
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.hil_state import HilStateInterface
from mavstack.simulators.outputs import Outputs
from mavstack.simulators.px4 import STEP, Px4Interface
from mavstack.simulators.simulator import Simulator
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.links import Channel, Link, LinkEvent
    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.sensor_model import SensorModels

FIRMWARES: Final = ("px4", "ardupilot")
#: Length of a step with ArduPilot, and time between two heartbeats, in seconds.
STATE_STEP: Final = 0.02
_HEARTBEAT: Final = 1.0
#: Real seconds without outputs after which the status reports this.
SILENCE: Final = 2.0


class HardwareSimulator(Simulator):
    """Simulates the world of a board that runs PX4 (SYS_HITL 1) or ArduPilot with HIL.

    Args:
        physics: The name of the physics; see `load_physics`.
        link: The URL of the link to the board, such as `serial:///dev/ttyACM0?baud=921600`.
        firmware: "px4" or "ardupilot".
        home: The place and heading of the vehicle at the start.
        seed: Seed of the sensors' noise.
        models: The errors of the sensors; None: those of a low-cost autopilot.
        on_connect: Called with a line when the link is open, and when the board drives its outputs.

    Raises:
        InvalidArgumentError: An argument is wrong; the text says which.
        LinkURLError: The URL is wrong.
    """

    def __init__(
        self,
        physics: str,
        link: str,
        *,
        firmware: str = "px4",
        home: Home = DEFAULT_HOME,
        seed: int = 1,
        models: SensorModels | None = None,
        on_connect: Callable[[str], None] = lambda line: None,
    ) -> None:
        if firmware not in FIRMWARES:
            raise InvalidArgumentError(f"there is no hardware in the loop with {firmware!r}: px4, ardupilot")
        super().__init__(physics, home=home, speed=1.0, seed=seed, models=models, on_connect=on_connect)
        if firmware == "ardupilot" and self._outputs not in (Outputs.SURFACES, Outputs.STEERING):
            raise InvalidArgumentError("ArduPilot's hardware in the loop flies planes and drives rovers only")
        dialect = Dialect.load("common")
        self._px4 = Px4Interface(dialect, self.sensors) if firmware == "px4" else None
        self._ardupilot = HilStateInterface(dialect, self.sensors)
        self._length = STEP * 1e-6 if self._px4 else STATE_STEP
        self._link: Link = open_link(link)
        self._encoder = Encoder(system=255, component=common.MavComponent.MISSIONPLANNER)
        self._channel: Channel | None = None
        self._reader: asyncio.Task[None] | None = None
        self._steps = 0
        self._beat = 0.0
        self._heard: float | None = None

    @property
    def time(self) -> float:
        """Seconds of the simulation."""
        return round(self._steps * self._length, 6)

    @property
    def port(self) -> int:
        """The port on which it listens; 0: it connects."""
        address = self._link.address
        return 0 if address is None else address[1]

    @property
    def status(self) -> str:
        """The event that each side waits for, in a sentence."""
        if self._channel is None:
            return "the simulator waits for the link to the board"
        if self._heard is None:
            return "the board takes sensors and does not drive its outputs yet: is SYS_HITL (HIL_MODE) set?"
        if asyncio.get_running_loop().time() - self._heard > SILENCE:
            return "the board has stopped sending outputs"
        return "the board flies by its own clock"

    async def _open(self) -> None:
        await self._link.open()
        self._reader = asyncio.get_running_loop().create_task(self._read())

    async def _close(self) -> None:
        if self._reader is not None:
            self._reader.cancel()
            with suppress(asyncio.CancelledError, LinkError):
                await self._reader
        await self._link.close()

    def _start(self) -> None:
        self._begin(self._step)

    async def _read(self) -> None:
        try:
            async for batch in self._link.batches():
                for event in batch:
                    self._take(event)
        except LinkError as error:
            self._end(error)

    def _take(self, event: LinkEvent) -> None:
        match event:
            case ChannelOpened(channel) if self._channel is None:
                self._channel = channel
                self._report(f"the link to the board is open: {channel.name}")
            case ChannelClosed(channel) if self._channel is channel:
                self._channel = self._heard = None
            case BytesReceived(channel, data) if self._channel is channel:
                self._received(bytes(data))
            case _:
                pass

    def _received(self, data: bytes) -> None:
        interface = self._px4 or self._ardupilot
        if not interface.feed(data):
            return
        if self._heard is None:
            self._report("the board drives its outputs")
        self._heard = asyncio.get_running_loop().time()

    def _step(self) -> None:
        self._steps += 1
        self._move(self._actuators(), self._length)
        if self._px4 is not None:
            data = self._px4.step(self.state)
        else:
            data = self._ardupilot.step(self.state, self.time)
        if self.time >= self._beat:
            self._beat = self.time + _HEARTBEAT
            data += self._encoder.encode(common.Heartbeat(type=common.MavType.GCS, mavlink_version=3))
        if self._channel is not None:
            with suppress(LinkClosedError):
                self._channel.write(data)
        asyncio.get_running_loop().call_soon(self._begin, self._step)

    def _actuators(self) -> Sequence[float]:
        if self._px4 is not None:
            return self._outputs.of_controls(self._px4.controls)
        return self._ardupilot.actuators(self._outputs)
