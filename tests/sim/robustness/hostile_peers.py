"""Hostile peers of a simulated vehicle, and the invariants that must hold for any input."""

from __future__ import annotations

from math import inf, isfinite, nan
from typing import TYPE_CHECKING, Any

from mavstack import Dialect, Parser
from mavstack.dialects import common
from mavstack.services import Address
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from collections.abc import Iterator
    from random import Random

    from mavstack.dialects import Message
    from mavstack.sim.port import Port
    from mavstack.sim.vehicle import SimulatedVehicle

ALL = Dialect.load("all")
ALL_VEHICLES = [(kind, firmware) for kind in VehicleType for firmware in Firmware]
GROUND = Address(255, common.MavComponent.MISSIONPLANNER)
#: Values that break arithmetic without range checks.
UNUSUAL_NUMBERS = (
    nan,
    inf,
    -inf,
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    90.0,
    -180.0,
    360.0,
    1e-30,
    1e6,
    -1e9,
    3.4e38,
    -3.4e38,
    16777217.0,
)
#: Fields that hold indices: small values refer to existing entries.
INDEX_FIELDS = {
    "seq",
    "count",
    "start_index",
    "end_index",
    "mission_type",
    "param_index",
    "id",
    "session",
    "opcode",
}


def unusual_number(random: Random) -> float:
    """Return an unusual number, a small one, or an angle in degrees."""
    return random.choice(
        [
            random.choice(UNUSUAL_NUMBERS),
            random.uniform(-10, 10),
            random.randint(0, 5),
            random.uniform(-180, 180),
        ]
    )


def state_of(vehicle: SimulatedVehicle) -> Iterator[tuple[str, float]]:
    """Yield all numbers of a vehicle's body, by name."""
    body = vehicle.body
    for name in ("truth", "estimate", "battery", "limits"):
        reading = getattr(body, name)
        for field in reading._fields:
            yield f"{name}.{field}", getattr(reading, field)
    for number, value in enumerate(body.servos):
        yield f"servo {number}", value


class TargetVehicle:
    """One vehicle, and a peer that sends arbitrary messages to it."""

    def __init__(self, simulation: Simulation, vehicle: SimulatedVehicle, random: Random) -> None:
        self.simulation, self.vehicle, self.random = simulation, vehicle, random
        self.port: Port = vehicle.open_port("hostile")
        self._encoders: dict[Address, Encoder] = {}
        self._parser = Parser(ALL)
        self.received: list[Message] = []

    def send(self, message: Message, source: Address = GROUND) -> None:
        encoder = self._encoders.get(source)
        if encoder is None:
            encoder = self._encoders[source] = Encoder(*source)
        self.vehicle.receive(self.port, encoder.encode(message))

    def place_in_air(self) -> None:
        """Place the armed vehicle in the air, in the mode that holds."""
        autopilot, kind = self.vehicle.autopilot, self.vehicle.vehicle_type
        autopilot.arm(force=True)
        if kind.flies:
            self.vehicle.body.place(0.0, 0.0, -60.0, 0.0)
        autopilot.enter(self.vehicle.profile.hold, "test", commanded=True)
        autopilot.landed = False

    def random_message(self) -> Message:
        """Return a random message, often addressed and numbered so that it is accepted."""
        random = self.random
        kind: Any = ALL[random.choice(ALL.names)]
        message = kind.from_payload(random.randbytes(255))
        for name in message.__match_args__:
            value = getattr(message, name)
            if name == "target_system":
                message.target_system = random.choice([self.vehicle.address.system] * 6 + [0, value])
            elif name == "target_component":
                message.target_component = random.choice([1, 1, 1, 0, value])
            elif isinstance(value, float) and random.random() < 0.7:
                setattr(message, name, unusual_number(random))
            elif isinstance(value, int) and name in INDEX_FIELDS and random.random() < 0.7:
                setattr(message, name, random.randint(0, 9))
        return message

    def random_source(self) -> Address:
        random = self.random
        return random.choice(
            [
                GROUND,
                GROUND,
                Address(1, 1),
                Address(0, 0),
                Address(random.randrange(256), random.randrange(256)),
            ]
        )

    def check(self) -> None:
        """Check the invariants: all numbers are finite, and all data sent is valid."""
        for name, value in state_of(self.vehicle):
            assert isfinite(value), (self.vehicle, name, value)
        for port, data in self.vehicle.data_to_send():
            if port is self.port:
                self.received += [
                    packet.message for packet in self._parser.feed(data) if packet.message is not None
                ]

    def drain_received(self) -> list[Message]:
        received, self.received = self.received, []
        return received


def target_vehicles(
    random: Random, *, seconds: float = 3.0, home: Home = DEFAULT_HOME, kinds: Any = None, **options: Any
) -> list[TargetVehicle]:
    """Return one vehicle of each kind in one simulation, some of them in the air."""
    simulation = Simulation(seed=random.randrange(1 << 30), **options)
    targets = [
        TargetVehicle(simulation, simulation.add(kind, firmware, home=home), random)
        for kind, firmware in kinds or ALL_VEHICLES
    ]
    simulation.advance(simulation.now + seconds)
    return targets
