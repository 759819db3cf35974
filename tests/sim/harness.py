"""The harness of simulated vehicles in tests, in virtual time.

Blocking, without links: a vehicle and a ground station that exchange bytes.

    copter = airborne("copter", "ardupilot", FS_GCS_ENABLE=1)
    copter.sends_heartbeats = False
    copter.run(8)
    assert copter.mode == "RTL" and "GCS Failsafe" in copter.texts

Several vehicles in one `SimulationHarness` cost little more than one. Vehicles are placed in the air rather
than flown there; wings start with a speed at which they can fly.

Simulations with links, in an event loop, are in `running.py`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from mavstack import Dialect, Parser, encode
from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.command import Command
from mavstack.sim.motion.state import StateArray
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from tests.waiting import step_until

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.services.mission import MissionItem

AnyMessage = TypeVar("AnyMessage", bound="Message")

CMD, RESULT = common.MavCmd, common.MavResult
GROUND = Address(255, common.MavComponent.MISSIONPLANNER)
#: Steps per second.
RATE = 50


HEIGHT, WING_HEIGHT, DEPTH = 20.0, 150.0, 10.0
_WING_SPEED = 18.0
_WINGS = (VehicleType.PLANE,)
_VELOCITY = StateArray.ROWS["velocity"][0]


class StatusTexts(list[str]):
    """The status texts of a vehicle in order, with their times in `times`."""

    def __init__(self, vehicle: Any) -> None:
        super().__init__()
        self.times: list[float] = []
        vehicle.add_listener(self._on_event)

    def _on_event(self, vehicle: Any, kind: str, text: str) -> None:
        if kind == "text":
            self.append(text)
            self.times.append(vehicle.now)

    def clear_texts(self) -> None:
        self.clear()
        self.times.clear()

    def first(self, start: str) -> str:
        """Return the first text with this start, or an empty one."""
        return next((text for text in self if text.startswith(start)), "")

    def time_of(self, text: str) -> float:
        return self.times[self.index(text)]


class VehicleHarness:
    """One simulated vehicle and its ground station."""

    #: Seconds in which commands are answered.
    answer_time = 1.0
    #: Default timeout of `run_until`, in seconds.
    default_timeout = 60.0

    def __init__(self, simulation_harness: SimulationHarness, vehicle: Any) -> None:
        self.simulation_harness, self.vehicle = simulation_harness, vehicle
        self._port: Any = None
        self.texts = StatusTexts(vehicle)
        self.modes: list[str] = []
        vehicle.add_listener(self._on_event)
        #: True if the ground station sends its heartbeat.
        self.sends_heartbeats = True
        #: A message that the ground station sends ten times a second.
        self.repeated_message: Callable[[], Message] | None = None
        self.source = GROUND
        #: The received messages, while `receiving` is true; parsing them all takes time.
        self.received: list[Message] = []
        self.receiving = False
        self._parser = Parser(Dialect.load("all"))
        self._sequence = 0

    def _on_event(self, _: Any, kind: str, text: str) -> None:
        if kind == "mode":
            self.modes.append(text.removeprefix("mode "))

    # Messages

    @property
    def simulation(self) -> Simulation:
        return self.simulation_harness.simulation

    @property
    def port(self) -> Any:
        """The port of the ground station, opened with its first message."""
        if self._port is None:
            self._port = self.vehicle.open_port("ground")
        return self._port

    def send(self, message: Message, source: Address | None = None) -> None:
        """Send a message to the vehicle, and collect the immediate answers."""
        system, component = source or self.source
        data = encode(message, system=system, component=component, sequence=self._sequence & 255)
        self._sequence += 1
        self.vehicle.receive(self.port, data)
        self.simulation_harness.collect()

    def collect(self, data: bytes) -> None:
        """Keep the messages in the data that the vehicle sent, if `receiving`."""
        if self.receiving:
            self.received.extend(packet.message for packet in self._parser.feed(data))

    def send_heartbeat(self) -> None:
        self.send(common.Heartbeat(type=common.MavType.GCS, autopilot=8, mavlink_version=3))

    def command(
        self,
        command: int,
        *params: float,
        frame: int | None = None,
        source: Address | None = None,
        wait: float | None = None,
    ) -> common.MavResult | None:
        """Send a command; return the last answer within `wait` (default: `answer_time`) seconds."""
        wait = self.answer_time if wait is None else wait
        before, receiving = len(self.received), self.receiving
        self.receiving = True
        sent, target = Command.of(command, params, frame), self.vehicle.address
        self.send(sent.to_long(target) if frame is None else sent.to_int(target), source)
        if wait:
            self.run(wait)
        self.receiving = receiving
        return self.result_of(command, before)

    def result_of(self, command: int, first: int = 0) -> common.MavResult | None:
        """Return the last answer to a command, among the messages received from number `first` on."""
        for message in reversed(self.received[first:]):
            if isinstance(message, common.CommandAck) and message.command == int(command):
                return RESULT(message.result)
        return None

    def set_parameter(self, name: str, value: float) -> None:
        """Set a parameter by PARAM_SET."""
        definition = self.vehicle.parameters.table[name]
        system, component = self.vehicle.address
        message = common.ParamSet(
            target_system=system,
            target_component=component,
            param_id=name,
            param_type=definition.kind,
            param_value=value,
        )
        self.send(message)
        self.run(0.2)

    def received_of(self, message_type: type[AnyMessage]) -> list[AnyMessage]:
        return [message for message in self.received if isinstance(message, message_type)]

    def without_telemetry(self) -> VehicleHarness:
        """Send no telemetry until the next boot, which saves most of a test's time."""
        server = self.vehicle.messages
        for message_id in server._streams:
            server.set_interval(message_id, 0, self.vehicle.now)
        return self

    # Time

    def run(self, seconds: float, each: Callable[[], object] | None = None) -> VehicleHarness:
        """Advance some seconds; `each` is called ten times a second."""
        self.simulation_harness.run(seconds, each)
        return self

    def run_until(
        self,
        condition: Callable[[], object],
        *,
        timeout: float | None = None,
        each: Callable[[], object] | None = None,
    ) -> VehicleHarness:
        """Advance until a condition holds; fail after `timeout` (default: `default_timeout`) seconds."""
        timeout = self.default_timeout if timeout is None else timeout
        self.simulation_harness.run_until(condition, timeout=timeout, each=each, description=lambda: self)
        return self

    # The vehicle

    def place_in_air(self, mode: str | None = None) -> VehicleHarness:
        """Arm in a mode, by default the one that holds, and move the vehicle into the air (a sub: down)."""
        autopilot, vehicle_type = self.autopilot, self.vehicle.vehicle_type
        assert not autopilot.arm(force=True)
        if vehicle_type.flies or vehicle_type is VehicleType.SUB:
            height = {VehicleType.PLANE: WING_HEIGHT, VehicleType.SUB: -DEPTH}.get(vehicle_type, HEIGHT)
            self.vehicle.body.place(0.0, 0.0, -height, 0.0)
        if vehicle_type in _WINGS:
            self.simulation.world.state.data[_VELOCITY, self.vehicle.body.column] = _WING_SPEED
        if mode is None:
            profile = self.vehicle.profile
            hovers = self.vehicle.firmware is Firmware.ARDUPILOT and vehicle_type is not VehicleType.SUB
            autopilot.enter(profile.guided if hovers else profile.hold, "test", commanded=True)
        else:
            self.enter(mode)
        autopilot.landed = False
        return self

    def mode_number(self, name: str) -> int:
        return next(mode.number for mode in self.vehicle.profile.modes if mode.name == name)

    def enter(self, mode: str) -> VehicleHarness:
        assert self.autopilot.enter(self.mode_number(mode), "test", commanded=True), mode
        return self

    def set(self, **parameters: float) -> VehicleHarness:
        for name, value in parameters.items():
            self.vehicle.parameters.set(name, value)
        return self

    def inject(self, *faults: str) -> VehicleHarness:
        for fault in faults:
            self.vehicle.faults.inject(fault)
        return self

    def load(self, *items: MissionItem) -> VehicleHarness:
        """Replace the mission; ArduPilot's home is put before it."""
        from mavstack.services.mission import MissionItem as Item
        from mavstack.services.mission import Plan

        home = []
        if self.vehicle.firmware is Firmware.ARDUPILOT:
            home = [Item(CMD.NAV_WAYPOINT, frame=common.MavFrame.GLOBAL)]
        assert self.vehicle.mission.accept(Plan.of([*home, *items]), GROUND) == 0
        self.vehicle.engine.touch(self.vehicle.mission)
        return self

    @property
    def autopilot(self) -> Any:
        return self.vehicle.autopilot

    @property
    def mode(self) -> str:
        return str(self.autopilot.mode.name)

    @property
    def armed(self) -> bool:
        return self.autopilot.armed

    @property
    def height(self) -> float:
        """True height above the ground, in metres."""
        return -self.vehicle.body.truth.down

    @property
    def critical(self) -> bool:
        """True if HEARTBEAT has the state CRITICAL."""
        return self.autopilot.system_status == common.MavState.CRITICAL

    def __str__(self) -> str:
        at = ", ".join(f"{value:.1f}" for value in self.vehicle.body.truth[:6])
        state = f"{self.vehicle.vehicle_type} in {self.mode}, armed {self.autopilot.armed}, at {at}"
        return f"{state}; {self.texts[-3:]}"


class SimulationHarness:
    """A simulation with several vehicles and their ground stations."""

    def __init__(self, *, seed: int = 1) -> None:
        self.simulation = Simulation(seed=seed)
        self.vehicles: list[VehicleHarness] = []
        self._steps = 0

    def add(
        self,
        vehicle_type: str = "copter",
        firmware: str = "ardupilot",
        *,
        home: Home = DEFAULT_HOME,
        **parameters: float,
    ) -> VehicleHarness:
        vehicle = self.simulation.add(VehicleType(vehicle_type), Firmware(firmware), home=home)
        return self.attach(VehicleHarness(self, vehicle)).set(**parameters)

    def attach(self, one: VehicleHarness) -> VehicleHarness:
        """Advance the ground station of a vehicle with the simulation."""
        self.vehicles.append(one)
        return one

    def run(self, seconds: float, each: Callable[[], object] | None = None) -> None:
        """Advance some seconds; `each` is called ten times a second."""
        for step in range(round(seconds * RATE)):
            self._step()
            if each is not None and step % 5 == 0:
                each()

    def run_until(
        self,
        condition: Callable[[], object],
        *,
        timeout: float = 60.0,
        each: Callable[[], object] | None = None,
        description: Callable[[], object] | str = "condition",
    ) -> None:
        """Advance until a condition holds; fail after `timeout` seconds."""
        step = self._step if each is None else lambda: self.run(0.2, each)
        step_until(condition, step, lambda: self.simulation.now, timeout=timeout, description=description)

    def collect(self) -> None:
        """Hand the data that vehicles sent to their ground stations."""
        for vehicle, _, data in self.simulation.data_to_send():
            self.vehicles[self.simulation.vehicles.index(vehicle)].collect(data)

    def _step(self) -> None:
        self.simulation.step()
        self._steps += 1
        if self._steps % 5 == 0:
            for one in self.vehicles:
                if one.sends_heartbeats and self._steps % RATE == 0:
                    one.send_heartbeat()
                if one.repeated_message is not None:
                    one.send(one.repeated_message())
        self.collect()


def grounded(
    vehicle_type: str = "copter", firmware: str = "ardupilot", *, seconds: float = 3.0, **parameters: float
) -> VehicleHarness:
    """Return a vehicle that can be armed."""
    return SimulationHarness().add(vehicle_type, firmware, **parameters).run(seconds)


def airborne(
    vehicle_type: str = "copter",
    firmware: str = "ardupilot",
    *,
    mode: str | None = None,
    **parameters: float,
) -> VehicleHarness:
    """Return a vehicle that holds in the air, or is in a mode there."""
    return grounded(vehicle_type, firmware, **parameters).place_in_air(mode).run(2.5)
