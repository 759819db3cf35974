"""The world of one Betaflight, by its UDP packets, in real time."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.betaflight import NEUTRAL_STICKS, BetaflightInterface, encode_sticks
from mavstack.simulators.outputs import Outputs
from mavstack.simulators.simulator import Simulator, listen_address

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.sensor_model import SensorModels

BETAFLIGHT_PORT: Final = 9002
#: Offsets of Betaflight's ports for the state and the transmitter from the port for the motors.
_STATE, _STICKS = 1, 2
#: Length of a step in seconds, and number of steps between two packets of the transmitter (50 Hz).
STEP: Final = 0.0025
_STICK_STEPS: Final = 8
#: Real seconds without motor outputs after which Betaflight counts as stopped.
SILENCE: Final = 2.0


class BetaflightSimulator(Simulator):
    """Simulates the world of one Betaflight; it may stop and start again at any time.

    Args:
        physics: The name of the physics, with motors as outputs; see `load_physics`.
        home: The place and heading of the vehicle at the start.
        listen: Where Betaflight sends its motors, `udpin://HOST:PORT`; it listens on the next two ports.
        target: The host of Betaflight.
        bridge: What its build expects: "gazebo" (the default build) or "legacy".
        motors: The order of its motors: "betaflight" (since 2026) or "gazebo".
        speed: Simulated seconds in a real second; Betaflight adapts its clock to it.
        seed: Seed of the sensors' noise.
        models: The errors of the sensors; None: those of a low-cost autopilot.
        on_connect: Called with a line when Betaflight drives its motors.

    Attributes:
        interface: The conversation with Betaflight.

    Raises:
        InvalidArgumentError: An argument is wrong; the text says which.
    """

    def __init__(
        self,
        physics: str = "copter",
        *,
        home: Home = DEFAULT_HOME,
        listen: str = f"udpin://127.0.0.1:{BETAFLIGHT_PORT}",
        target: str = "127.0.0.1",
        bridge: str = "gazebo",
        motors: str = "betaflight",
        speed: float = 1.0,
        seed: int = 1,
        models: SensorModels | None = None,
        on_connect: Callable[[str], None] = lambda line: None,
    ) -> None:
        self._address, self._target = listen_address(listen, "udpin"), target
        super().__init__(physics, home=home, speed=speed, seed=seed, models=models, on_connect=on_connect)
        if self._outputs is not Outputs.MOTORS:
            raise InvalidArgumentError(f"Betaflight drives motors, which the physics {physics} has not")
        self.interface = BetaflightInterface(self.sensors, home, bridge=bridge, motors=motors)
        self._steps, self._port = 0, 0
        self._channels: tuple[int, ...] = NEUTRAL_STICKS
        self._heard: float | None = None
        self._has_set_clock = False
        self._transport: asyncio.DatagramTransport | None = None

    @property
    def time(self) -> float:
        """Seconds of the simulation."""
        return self._steps * STEP

    @property
    def port(self) -> int:
        """The port on which it listens."""
        return self._port

    @property
    def status(self) -> str:
        """The event that each side waits for, in a sentence."""
        if self.pace.is_paused:
            return "the simulation is paused"
        if self._heard is None:
            return "the simulator sends its state and waits for motors of Betaflight"
        if asyncio.get_running_loop().time() - self._heard > SILENCE:
            return "Betaflight has stopped sending motors"
        return "Betaflight flies by its own clock"

    def set_sticks(self, channels: Sequence[int]) -> None:
        """Set the channels of the transmitter.

        Args:
            channels: Up to 16 channels in microseconds: roll, pitch, throttle, yaw, switches.

        Raises:
            InvalidArgumentError: There are more than 16 channels, or one is outside 0 to 3000 µs.
        """
        encode_sticks(channels, 0.0)
        self._channels = tuple(channels)

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
        self._begin(self._step)

    def take(self, data: bytes) -> None:
        """Take a packet of motors."""
        if not self.interface.feed(data):
            return
        if self._heard is None:
            self._report("Betaflight is connected")
        self._heard = asyncio.get_running_loop().time()

    def _step(self) -> None:
        if self._transport is None:
            return
        self._steps += 1
        self._move(self.interface.controls, STEP)
        state = self.interface.step(self.state, self.time, clock=self._clock())
        self._transport.sendto(state, (self._target, self._port + _STATE))
        if self._steps % _STICK_STEPS == 1:
            sticks = encode_sticks(self._channels, self.time)
            self._transport.sendto(sticks, (self._target, self._port + _STICKS))
        asyncio.get_running_loop().call_soon(self._begin, self._step)

    def _clock(self) -> float:
        """Return the time that Betaflight sees.

        It sets the rate of its clock by the times of the last two packets over the real time between them.
        Two that arrive at once, as on a busy machine, let it race fifty times faster until the next one:
        transmitter and GPS time out, and it disarms. Packets of one time leave its clock at the real rate.
        """
        self._has_set_clock = self._has_set_clock or self.pace.speed != 1.0
        return self.time if self._has_set_clock else 0.0


class _Datagrams(asyncio.DatagramProtocol):
    def __init__(self, simulator: BetaflightSimulator) -> None:
        self._simulator = simulator

    def datagram_received(self, data: bytes, addr: tuple[Any, ...]) -> None:
        self._simulator.take(data)

    def error_received(self, exc: Exception) -> None:
        """Ignore that Betaflight does not listen yet."""
