"""The world of one ArduPilot, by its JSON interface over UDP.

ArduPilot asks for each step and waits for the answer, so it sets the speed (`--speedup`); an answer that is
held back, by a speed or a pause, holds ArduPilot back.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import LinkError
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.ardupilot import JsonInterface
from mavstack.simulators.simulator import Simulator, listen_address

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.sensor_model import SensorModels

ARDUPILOT_PORT: Final = 9002
#: Real seconds without a datagram from ArduPilot after which it counts as stopped.
SILENCE: Final = 2.0


class ArduPilotSimulator(Simulator):
    """Simulates the world of one ArduPilot; ArduPilot may stop and start again at any time.

    Args:
        physics: The name of the physics; see `load_physics`.
        home: The place and heading of the vehicle at the start.
        listen: Where ArduPilot asks, `udpin://HOST:PORT`.
        speed: Simulated seconds in a real second; 0: as fast as ArduPilot asks.
        seed: Seed of the sensors' noise.
        models: The errors of the sensors; None: those of a low-cost autopilot.
        equipment: Sensors beside the usual ones: "rangefinder".
        on_connect: Called with a line when ArduPilot was started, first or again.

    Attributes:
        interface: The conversation with ArduPilot.
    """

    def __init__(
        self,
        physics: str = "copter",
        *,
        home: Home = DEFAULT_HOME,
        listen: str = f"udpin://127.0.0.1:{ARDUPILOT_PORT}",
        speed: float = 0.0,
        seed: int = 1,
        models: SensorModels | None = None,
        equipment: Iterable[str] = (),
        on_connect: Callable[[str], None] = lambda line: None,
    ) -> None:
        self._address = listen_address(listen, "udpin")
        super().__init__(
            physics,
            home=home,
            speed=speed,
            seed=seed,
            models=models,
            equipment=equipment,
            on_connect=on_connect,
        )
        self.interface = JsonInterface(self._physics, self._outputs, home, self.sensors, self._started)
        self._starts = 0
        self._transport: asyncio.DatagramTransport | None = None
        self._port = 0
        self._asked: float | None = None
        self._question: tuple[bytes, tuple[Any, ...]] | None = None

    @property
    def time(self) -> float:
        """Seconds of the simulation since ArduPilot was started."""
        return self.interface.time

    @property
    def port(self) -> int:
        """The port on which it listens."""
        return self._port

    @property
    def status(self) -> str:
        """The event that each side waits for, in a sentence."""
        if self.pace.is_paused:
            return "the simulation is paused"
        if self._asked is None:
            return "the simulator waits for servo outputs of ArduPilot (--model JSON:127.0.0.1)"
        silence = asyncio.get_running_loop().time() - self._asked
        if silence > SILENCE:
            return (
                f"ArduPilot has not asked for {silence:.0f} s: it was stopped, or it waits for a client of"
                " its first serial port (TCP 5760)"
            )
        return "ArduPilot asks for each step and waits for the answer"

    async def _open(self) -> None:
        host, port = self._address
        loop = asyncio.get_running_loop()
        try:
            self._transport, _ = await loop.create_datagram_endpoint(
                lambda: _Datagrams(self), local_addr=(host, port)
            )
        except OSError as error:
            raise LinkError(f"cannot listen on udpin://{host}:{port}: {error.strerror or error}") from error
        self._port = int(self._transport.get_extra_info("sockname")[1])

    async def _close(self) -> None:
        if self._transport is not None:
            self._transport.close()
            await asyncio.sleep(0)  # until the port is free

    def _start(self) -> None:
        self._resumed()

    def take(self, data: bytes, address: tuple[Any, ...]) -> None:
        """Take a datagram; it is answered when the pace allows it."""
        self._asked = asyncio.get_running_loop().time()
        if self.interface.is_step(data):
            self._question = (data, address)
            self._begin(self._step)
        else:
            self._answer(data, address)

    def _step(self) -> None:
        """Make the step of the latest question."""
        if self._question is None:
            return
        question, self._question = self._question, None
        self._answer(*question)
        self.state = self.interface.state
        if self.time >= self._until:
            self._end()

    def _answer(self, data: bytes, address: tuple[Any, ...]) -> None:
        answer = self.interface.answer(data)
        if answer is not None and self._transport is not None:
            self._transport.sendto(answer, address)

    def _started(self) -> None:
        self._starts += 1
        self._report("ArduPilot is connected" if self._starts == 1 else "ArduPilot was started again")


class _Datagrams(asyncio.DatagramProtocol):
    def __init__(self, simulator: ArduPilotSimulator) -> None:
        self._simulator = simulator

    def datagram_received(self, data: bytes, addr: tuple[Any, ...]) -> None:
        self._simulator.take(data, addr)
