"""A simulated vehicle with its services and telemetry, and the modes of the autopilot tests.

flight = Flight(VehicleType.COPTER, Firmware.PX4)
flight.run(5.0)
flight.newest(common.Attitude)
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import Dialect, Message, common
from mavstack.services import Address
from mavstack.sim.motion import World
from mavstack.sim.parameters import Parameters
from mavstack.sim.telemetry import publish_ardupilot, publish_px4
from mavstack.sim.vehicle import SimulatedVehicle
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from mavstack.wire import Encoder, Packet, Parser
from tests.sim.autopilot.harness import TAKEOFF, StubProfile, default_behaviours, new_flight_parameters
from tests.waiting import step_until

if TYPE_CHECKING:
    from collections.abc import Callable

AnyMessage = TypeVar("AnyMessage", bound=Message)

START = 1_700_000_000.0
RATE = 50.0
GROUND = Address(255, 190)
VEHICLES = [(vehicle_type, firmware) for vehicle_type in VehicleType for firmware in Firmware]
VEHICLE_IDS = [f"{firmware}-{vehicle_type}" for vehicle_type, firmware in VEHICLES]


class TelemetryProfile(StubProfile):
    """A firmware profile that has only telemetry."""

    def __init__(self, vehicle_type: VehicleType, firmware: Firmware) -> None:
        super().__init__(new_flight_parameters(vehicle_type), default_behaviours())
        self.transmitter = firmware is Firmware.ARDUPILOT
        self._firmware = firmware

    def provide(self, vehicle: Any) -> None:
        self._flight_parameters.body = vehicle.body
        (publish_px4 if self._firmware is Firmware.PX4 else publish_ardupilot)(vehicle)


def new_vehicle(
    world: World,
    vehicle_type: VehicleType = VehicleType.COPTER,
    firmware: Firmware = Firmware.ARDUPILOT,
    *,
    home: Home = DEFAULT_HOME,
    system: int = 1,
    **parameters: float,
) -> SimulatedVehicle:
    """Add a vehicle to a world, with some parameters set."""
    table = Parameters(firmware, vehicle_type, system)
    for name, value in parameters.items():
        table.set(name, value)
    profile = TelemetryProfile(vehicle_type, firmware)
    return SimulatedVehicle(
        world.add(vehicle_type, home), vehicle_type, firmware, Address(system, 1), profile, table, now=START
    )


class Flight:
    """One vehicle, one peer, and their time."""

    def __init__(
        self,
        vehicle_type: VehicleType = VehicleType.COPTER,
        firmware: Firmware = Firmware.ARDUPILOT,
        *,
        system: int = 1,
        **parameters: float,
    ) -> None:
        self.world = World(seed=1, rate=RATE)
        self.vehicle = new_vehicle(self.world, vehicle_type, firmware, system=system, **parameters)
        self.port = self.vehicle.open_port("ground")
        self.packets: list[tuple[float, Packet]] = []
        self._encoder = Encoder(*GROUND)
        self._parser = Parser(Dialect.load("all"))
        self._steps = 0

    @property
    def now(self) -> float:
        return START + self._steps / RATE

    @property
    def body(self) -> Any:
        return self.vehicle.body

    def step(self) -> None:
        self.world.step()
        self._steps += 1
        self.vehicle.step(self.now)
        for _, data in self.vehicle.data_to_send():
            self.packets += [(self.now, packet) for packet in self._parser.feed(data, self.now)]

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * RATE)):
            self.step()

    def run_until(self, holds: Callable[[], bool], *, timeout: float) -> None:
        step_until(holds, self.step, lambda: self.now, timeout=timeout)

    def send(self, message: Message) -> None:
        """Send a message from the peer to the vehicle."""
        self.vehicle.receive(self.port, self._encoder.encode(message, self.now))

    def command(self, command: int, *params: float) -> None:
        fields = {f"param{place}": value for place, value in enumerate(params, 1)}
        self.send(common.CommandLong(target_system=1, target_component=1, command=command, **fields))

    def fly(self, seconds: float = 15.0) -> Flight:
        """Arm, and take off if the type can."""
        self.run(3.0)
        assert not self.vehicle.autopilot.arm()
        self.vehicle.autopilot.enter(TAKEOFF, "test")
        self.run(seconds)
        return self

    # Received messages

    def rates(self, seconds: float) -> Counter[str]:
        """Count each message that is received in the next seconds."""
        self.packets.clear()
        self.run(seconds)
        return Counter(type(packet.message).__name__ for _, packet in self.packets)

    def newest(self, message_type: type[AnyMessage], *, timeout: float = 11.0) -> AnyMessage:
        """Return the next message of a type."""
        self.packets.clear()
        steps = 0
        while True:
            for _, packet in self.packets:
                if isinstance(packet.message, message_type):
                    return packet.message
            assert steps < timeout * RATE, f"no {message_type.__name__} within {timeout} s"
            self.packets.clear()
            self.step()
            steps += 1
