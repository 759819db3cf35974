"""Simulated vehicles for tests, each with a ground station beside it, in virtual time.

    copter = airborne("copter", "ardupilot", FS_GCS_ENABLE=1)
    copter.talks = False
    copter.run(8)
    assert copter.mode == "RTL" and "GCS Failsafe" in copter.texts

Several vehicles in one `Airspace` cost little more than one. What leaves the ground is put into the air at
once rather than flown there, but for wings, which are let go fast enough to fly.
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
HEIGHT, WING_HEIGHT, DEPTH = 20.0, 150.0, 10.0
_WING_SPEED = 18.0
_WINGS = (VehicleType.PLANE,)
_VELOCITY = StateArray.ROWS["velocity"][0]


class Texts(list[str]):
    """What a vehicle says, in order; when it said each is in `times`."""

    def __init__(self, vehicle: Any) -> None:
        super().__init__()
        self.times: list[float] = []
        vehicle.listeners.append(self._told)

    def _told(self, vehicle: Any, kind: str, text: str) -> None:
        if kind == "text":
            self.append(text)
            self.times.append(vehicle.now)

    def forget(self) -> None:
        self.clear()
        self.times.clear()

    def first(self, start: str) -> str:
        """The first text that begins so."""
        return next((text for text in self if text.startswith(start)), "")

    def time_of(self, text: str) -> float:
        return self.times[self.index(text)]


class Flown:
    """One vehicle and its ground station."""

    def __init__(self, airspace: Airspace, vehicle: Any) -> None:
        self.airspace, self.vehicle = airspace, vehicle
        self._port: Any = None
        self.texts = Texts(vehicle)
        self.modes: list[str] = []
        vehicle.listeners.append(self._told)
        #: Whether the ground station sends its heartbeat.
        self.talks = True
        #: What the station says besides, ten times a second.
        self.repeats: Callable[[], Message] | None = None
        self.source = GROUND
        self.heard: list[Message] = []
        self.listens = False
        self._parser = Parser(Dialect.load("all"))
        self._sequence = 0

    def _told(self, _: Any, kind: str, text: str) -> None:
        if kind == "mode":
            self.modes.append(text.removeprefix("mode "))

    # Talking

    @property
    def port(self) -> Any:
        """Where the station meets it: there is no link before somebody says something."""
        if self._port is None:
            self._port = self.vehicle.open_port("ground")
        return self._port

    def send(self, message: Message, source: Address | None = None) -> None:
        source = source or self.source
        data = encode(
            message, system=source.system, component=source.component, sequence=self._sequence & 255
        )
        self._sequence += 1
        self.vehicle.receive(self.port, data)

    def beat(self) -> None:
        self.send(common.Heartbeat(type=common.MavType.GCS, autopilot=8, mavlink_version=3))

    def command(self, command: int, *params: float) -> common.MavResult | None:
        """Send a command; gives the last answer that comes within a second."""
        before, listened = len(self.heard), self.listens
        self.listens = True
        self.send(Command.of(command, params, None).to_long(self.vehicle.address))
        self.run(1.0)
        self.listens = listened
        acks = [ack for ack in self.heard[before:] if isinstance(ack, common.CommandAck)]
        return RESULT(acks[-1].result) if acks else None

    def set_parameter(self, name: str, value: float) -> None:
        """By PARAM_SET, as a ground station does."""
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

    def all_of(self, kind: type[AnyMessage]) -> list[AnyMessage]:
        return [message for message in self.heard if isinstance(message, kind)]

    def mute(self) -> Flown:
        """Send no telemetry until the next boot, which saves most of the time that a test takes."""
        server = self.vehicle.messages
        for message_id in server._streams:
            server.set_interval(message_id, 0, self.vehicle.now)
        return self

    # Time

    def run(self, seconds: float) -> Flown:
        self.airspace.run(seconds)
        return self

    def run_until(self, holds: Callable[[], bool], *, timeout: float = 60.0) -> Flown:
        self.airspace.run_until(holds, timeout=timeout)
        return self

    # The vehicle

    def put_into_the_air(self, mode: str | None = None) -> Flown:
        """Arm, in a mode or the one that holds, and be up there (a sub: down there)."""
        autopilot, kind = self.autopilot, self.vehicle.type
        assert not autopilot.arm(force=True)
        if kind.flies or kind is VehicleType.SUB:
            height = {VehicleType.PLANE: WING_HEIGHT, VehicleType.SUB: -DEPTH}.get(kind, HEIGHT)
            self.vehicle.body.place(0.0, 0.0, -height, 0.0)
        if kind in _WINGS:
            state = self.airspace.simulation.world.state
            state.data[_VELOCITY, self.vehicle.body.column] = _WING_SPEED
        if mode is None:
            profile = self.vehicle.profile
            hovers = self.vehicle.firmware is Firmware.ARDUPILOT and kind is not VehicleType.SUB
            autopilot.enter(profile.guided if hovers else profile.hold, "test", commanded=True)
        else:
            self.enter(mode)
        autopilot.landed = False
        return self

    def enter(self, mode: str) -> Flown:
        number = next(known.number for known in self.vehicle.profile.modes if known.name == mode)
        assert self.autopilot.enter(number, "test", commanded=True), mode
        return self

    def set(self, **parameters: float) -> Flown:
        for name, value in parameters.items():
            self.vehicle.parameters.set(name, value)
        return self

    def inject(self, *faults: str) -> Flown:
        for fault in faults:
            self.vehicle.faults.inject(fault)
        return self

    def load(self, *items: MissionItem) -> Flown:
        """Have a mission; ArduPilot's home is put before it."""
        from mavstack.services.mission import MissionItem as Item
        from mavstack.services.mission import Plan

        home = [Item(CMD.NAV_WAYPOINT)] if self.vehicle.firmware is Firmware.ARDUPILOT else []
        assert self.vehicle.mission.take(Plan.of([*home, *items]), GROUND) == 0
        self.vehicle.engine.touch(self.vehicle.mission)
        return self

    @property
    def autopilot(self) -> Any:
        return self.vehicle.autopilot

    @property
    def mode(self) -> str:
        return self.autopilot.mode.name

    @property
    def armed(self) -> bool:
        return self.autopilot.armed

    @property
    def height(self) -> float:
        return -self.vehicle.body.truth.down

    @property
    def critical(self) -> bool:
        """Whether HEARTBEAT says so."""
        return self.autopilot.system_status == common.MavState.CRITICAL


class Airspace:
    """A simulation with several of them."""

    def __init__(self, *, seed: int = 1) -> None:
        self.simulation = Simulation(seed=seed)
        self.flown: list[Flown] = []
        self._steps = 0

    def add(
        self,
        kind: str = "copter",
        firmware: str = "ardupilot",
        *,
        home: Home = DEFAULT_HOME,
        **parameters: float,
    ) -> Flown:
        one = Flown(self, self.simulation.add(VehicleType(kind), Firmware(firmware), home=home))
        self.flown.append(one)
        return one.set(**parameters)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * 50)):
            self._step()

    def run_until(self, holds: Callable[[], bool], *, timeout: float = 60.0) -> None:
        step_until(holds, self._step, lambda: self.simulation.now, timeout=timeout)

    def _step(self) -> None:
        self.simulation.step()
        self._steps += 1
        if self._steps % 5 == 0:
            for one in self.flown:
                if one.talks and self._steps % 50 == 0:
                    one.beat()
                if one.repeats is not None:
                    one.send(one.repeats())
        for vehicle, _, data in self.simulation.data_to_send():
            one = self.flown[vehicle.address.system - 1]
            if one.listens:
                one.heard.extend(packet.message for packet in one._parser.feed(data))


def grounded(
    kind: str = "copter", firmware: str = "ardupilot", *, seconds: float = 3.0, **parameters: float
) -> Flown:
    """A vehicle that is ready to be armed."""
    return Airspace().add(kind, firmware, **parameters).run(seconds)


def airborne(
    kind: str = "copter", firmware: str = "ardupilot", *, mode: str | None = None, **parameters: float
) -> Flown:
    """A vehicle that holds in the air, or is in a mode there."""
    return grounded(kind, firmware, **parameters).put_into_the_air(mode).run(2.5)
