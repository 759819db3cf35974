"""The world of one PX4, in lockstep over TCP.

Steps are made by callbacks: an answer of PX4 moves the body, and sends the next sensors at once or by the
pace. Until PX4 answers, steps follow each other after a short wait; with rovers and boats later too.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final, cast

from mavstack.dialects import Dialect
from mavstack.errors import LinkError
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.outputs import Outputs
from mavstack.simulators.px4 import STEP, Phase, Px4Interface
from mavstack.simulators.simulator import Simulator, listen_address, log

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.sensor_model import SensorModels

PX4_PORT: Final = 4560
#: Seconds to wait for an answer of PX4 while it starts and does not drive its outputs yet.
START_UP_WAIT: Final = 0.02
#: Seconds to wait for an answer of PX4 with a rover or boat: PX4 sends their outputs only when it sets them.
STEERING_WAIT: Final = 0.002
#: Real seconds without an answer in lockstep after which a message is logged.
SILENCE: Final = 5.0


class Px4Simulator(Simulator):
    """Simulates the world of one PX4.

    Each PX4 that connects finds a new world: the body at home, the time at its start.

    Args:
        physics: The name of the physics; see `load_physics`.
        home: The place and heading of the vehicle at the start.
        listen: Where PX4 connects, `tcpin://HOST:PORT`.
        speed: Simulated seconds in a real second; 0: as fast as PX4 answers.
        seed: Seed of the sensors' noise.
        models: The errors of the sensors; None: those of a low-cost autopilot.
        equipment: Sensors beside the usual ones: "rangefinder", "optical-flow".
        on_connect: Called with a line when PX4 connects and when it answers for the first time.

    Attributes:
        interface: The conversation with PX4.

    Raises:
        InvalidArgumentError: An argument is wrong; the text says which.
    """

    def __init__(
        self,
        physics: str = "copter",
        *,
        home: Home = DEFAULT_HOME,
        listen: str = f"tcpin://127.0.0.1:{PX4_PORT}",
        speed: float = 1.0,
        seed: int = 1,
        models: SensorModels | None = None,
        equipment: Iterable[str] = (),
        on_connect: Callable[[str], None] = lambda line: None,
    ) -> None:
        self._address = listen_address(listen, "tcpin")
        self._dialect = Dialect.load("common")
        super().__init__(
            physics,
            home=home,
            speed=speed,
            seed=seed,
            models=models,
            equipment=equipment,
            on_connect=on_connect,
        )
        self.interface = Px4Interface(self._dialect, self.sensors)
        self._server: asyncio.Server | None = None
        self._connection: asyncio.Transport | None = None
        self._port = 0
        self._waits = False  # a step was sent and not answered yet
        self._watch: asyncio.TimerHandle | None = None
        self._start_up: asyncio.TimerHandle | None = None

    @property
    def time(self) -> float:
        """Seconds of the simulation."""
        return self.interface.seconds

    @property
    def port(self) -> int:
        """The port on which it listens."""
        return self._port

    @property
    def status(self) -> str:
        """The event that each side waits for, in a sentence."""
        return "the simulation is paused" if self.pace.is_paused else self.interface.phase.value

    async def _open(self) -> None:
        host, port = self._address
        loop = asyncio.get_running_loop()
        try:
            self._server = await loop.create_server(lambda: _Connection(self), host, port)
        except OSError as error:
            raise LinkError(f"cannot listen on tcpin://{host}:{port}: {error.strerror or error}") from error
        self._port = int(self._server.sockets[0].getsockname()[1])

    async def _close(self) -> None:
        for timer in (self._watch, self._start_up):
            if timer is not None:
                timer.cancel()
        if self._server is not None:
            self._server.close()
        if self._connection is not None:
            self._connection.close()

    def _start(self) -> None:
        if self._connection is not None and not self._waits:
            self._begin(self._send)

    # Called by the connection

    def accept(self, connection: asyncio.Transport) -> bool:
        """Take a connection of PX4; returns False if there is one already."""
        if self._connection is not None:
            log.warning("a second program connected and was refused: each PX4 needs its own simulator")
            return False
        self._connection = connection
        self._waits, self._waiting = False, None
        self._place()
        self.interface = Px4Interface(self._dialect, self.sensors)
        self.interface.connected()
        self._report("PX4 is connected; it waits for sensors and starts")
        self._watch_answers(-1)
        self._begin(self._send)
        return True

    def receive(self, data: bytes) -> None:
        """Take bytes of PX4."""
        starts = self.interface.phase is Phase.START_UP
        if not self.interface.feed(data) or not self._waits:
            return
        if starts:
            self._report(f"PX4 drives its outputs after {self.time:.2f} s: lockstep")
        self._finish()

    def disconnect(self) -> None:
        """Note that PX4 has disconnected."""
        self._connection, self._waits, self._waiting = None, False, None
        self.interface.closed()
        if self._until == float("inf"):
            self._end()
        else:
            self._end(
                LinkError(
                    f"PX4 disconnected after {self.time:.3f} s; it and the simulator start again together"
                )
            )

    # Steps

    def _send(self) -> None:
        """Send the sensors of the next step."""
        if self._connection is None:
            return
        self._connection.write(self.interface.step(self.state))
        self._waits = True
        wait = self._answer_timeout()
        if wait is not None:
            loop = asyncio.get_running_loop()
            self._start_up = loop.call_later(wait, self._skip_answer, self.interface.steps)

    def _answer_timeout(self) -> float | None:
        """Return the real seconds after which the next step follows without an answer; None: it does not."""
        if self.interface.phase is Phase.START_UP:
            return START_UP_WAIT
        return STEERING_WAIT if self._outputs is Outputs.STEERING else None

    def _skip_answer(self, step: int) -> None:
        if self._waits and step == self.interface.steps and self._answer_timeout() is not None:
            self._finish()

    def _finish(self) -> None:
        """Move the body by the outputs, and begin the next step."""
        self._waits = False
        if self._start_up is not None:
            self._start_up.cancel()
            self._start_up = None
        try:
            self._move(self._outputs.of_controls(self.interface.controls), STEP * 1e-6)
        except Exception as error:  # noqa: BLE001 (of a user's physics)
            self._end(error)
            return
        self._begin(self._send)

    def _watch_answers(self, step: int) -> None:
        """Log once if PX4 does not answer for a long time."""
        interface = self.interface
        if self._waits and step == interface.steps and interface.phase is Phase.LOCKSTEP:
            interface.overdue()
            log.warning("PX4 has not answered step %d for %g s", step, SILENCE)
        loop = asyncio.get_running_loop()
        if self._watch is not None:
            self._watch.cancel()
        self._watch = loop.call_later(SILENCE, self._watch_answers, interface.steps)


class _Connection(asyncio.Protocol):
    """A connection of PX4."""

    def __init__(self, simulator: Px4Simulator) -> None:
        self._simulator = simulator
        self._transport: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        stream = cast("asyncio.Transport", transport)
        if self._simulator.accept(stream):
            self._transport = stream
        else:
            stream.close()

    def data_received(self, data: bytes) -> None:
        if self._transport is not None:
            self._simulator.receive(data)

    def connection_lost(self, exc: Exception | None) -> None:
        if self._transport is not None:
            self._simulator.disconnect()
