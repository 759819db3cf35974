"""All detectors beside simulated flights: no false alarm, and each attack is found in the middle of them."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from mavstack.dialects import common
from mavstack.router.config import Table
from mavstack.router.config.names import Names
from mavstack.router.firewall import Firewall, Traffic, detector_names, read_firewall
from mavstack.sim.vehicle_types import Firmware
from mavstack.wire import Parser
from tests.router.firewall.packets import Sender, command, ground_heartbeat, heartbeat
from tests.sim.whole_flights.plans import triangle
from tests.vehicle.world import ARDUPILOT, PX4, VehicleType, fly

pytestmark = pytest.mark.flight

ARM, RTL, FORCE = 400, 20, 21196
PARAMETERS = {ARDUPILOT: "RTL_SPEED", PX4: "RTL_RETURN_ALT"}
#: A request of the second ground station.
READ = common.ParamRequestRead(target_system=1, target_component=1, param_index=7)


@cache
def flight(firmware: Firmware) -> tuple[tuple[object, float], ...]:
    """The packets of a flight and their times: a mission, setpoints, parameters, downloads."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "flight.tlog"

        async def scenario(world, vehicle):
            async with world.node.record(path):
                await prepare(vehicle, firmware)
                await vehicle.arm()
                await vehicle.takeoff(12)
                await in_the_air(vehicle, firmware)
                await vehicle.mission.fly(timeout=900)

        fly((VehicleType.COPTER, firmware), scenario, payloads=True)
        packets = Parser(common, timestamped=True).feed(path.read_bytes())
    return tuple((packet, packet.timestamp / 1e6) for packet in packets)


async def prepare(vehicle, firmware):
    await vehicle.params.download()
    await vehicle.params.set(PARAMETERS[firmware], 30)
    await vehicle.mission.upload(triangle(VehicleType.COPTER, firmware).items)
    await vehicle.mission.download()
    await vehicle.ftp.list("/")
    await vehicle.logs.list()


async def in_the_air(vehicle, firmware):
    async with vehicle.guided() as guided:
        guided.position(10, 0, 12)
        guided.velocity(1, 0, 0)
    await vehicle.params.set(PARAMETERS[firmware], 25)
    await vehicle.mission.set_current(1)


class Router:
    """A firewall with all detectors, between the link of the vehicle and that of the ground."""

    def __init__(self) -> None:
        names = ", ".join(f'"{name}"' for name in detector_names())
        text = f'[firewall]\ndefault = "allow"\ndetectors = [{names}]\n'
        self.firewall = Firewall(read_firewall(Table.parse(text, "x").table("firewall"), Names("common")))
        self._counts = {"vehicle": 0, "ground": 0}
        self._measured = 0.0
        self._second = Sender(254, 190)
        for name in self._counts:
            self.firewall.open_endpoint(name)

    def pass_on(self, packet, now: float) -> bool:
        """Decide about a packet; once a second measure the links, and let a second station read."""
        origin = "vehicle" if packet.system == 1 else "ground"
        self._counts[origin] += 1
        if now - self._measured > 1:
            self._measured = now
            for name, count in self._counts.items():
                self.firewall.measure(name, Traffic(count, 0), now)
            for reading in (ground_heartbeat(), READ, command(512, 148), command(511, 33, 500_000)):
                assert self.firewall.decide("ground", self._second.packet(reading), now)
        return self.firewall.decide(origin, packet, now)

    def detectors(self) -> list[str]:
        """The detectors that raised alerts since the last call."""
        return [alert.detector for alert in self.firewall.alerts()]


@pytest.mark.flight_cases(1)
@pytest.mark.parametrize("firmware", Firmware)
def test_a_flight_raises_no_alert(firmware):
    router = Router()
    packets = flight(firmware)
    assert all(router.pass_on(*each) for each in packets)
    assert [str(alert) for alert in router.firewall.alerts()] == []
    seen = {packet.name for packet, _ in packets}
    assert {"COMMAND_LONG", "MISSION_ITEM_INT", "PARAM_SET", "FILE_TRANSFER_PROTOCOL"} <= seen


def attacks(recorded):
    """Name of the detector, link and packet of each attack; `recorded` is the pilot's last command."""
    pilot, other = Sender(255, 190), Sender(254, 190)
    return [
        ("spoofed-ids", "ground", Sender(1, 1).packet(heartbeat())),
        ("spoofed-ids", "vehicle", Sender(1, 1).packet(heartbeat(kind=common.MavType.SUBMARINE))),
        ("injected-positions", "ground", pilot.packet(common.HilGps(lat=1))),
        ("injected-positions", "ground", other.packet(common.GpsInput(lat=1))),
        ("replays", "ground", recorded),
        ("malformed", "ground", pilot.packet(common.TrajectoryRepresentationWaypoints(valid_points=200))),
        ("behaviour", "ground", other.packet(command(RTL))),
        ("behaviour", "ground", other.packet(command(ARM, 0))),
        ("behaviour", "ground", other.packet(command(ARM, 0, FORCE))),
        ("spoofed-ids", "vehicle", pilot.packet(command(RTL))),
        ("behaviour", "ground", Sender(253, 1).packet(common.MissionClearAll(target_system=1))),
        ("behaviour", "ground", Sender(252, 1).packet(common.SetMode(target_system=1))),
    ]


@pytest.mark.flight_cases(1)
@pytest.mark.parametrize("firmware", Firmware)
def test_each_attack_on_a_flying_vehicle_is_found(firmware):
    router = Router()
    packets = flight(firmware)
    middle = next(
        number for number, (packet, _) in enumerate(packets)
        if number > len(packets) // 2 and packet.name == "HEARTBEAT" and packet.system == 1
    )  # fmt: skip
    now = packets[middle][1]
    commands = [
        packet for packet, at in packets[:middle]
        if packet.name == "COMMAND_LONG" and packet.system == 255 and now - at > 2
    ]  # fmt: skip
    for each in packets[:middle]:
        assert router.pass_on(*each)
    for step, (name, origin, forged) in enumerate(attacks(commands[-1])):
        counts = router.firewall.counts.copy()
        assert not router.firewall.decide(origin, forged, now + step * 0.01), name
        assert router.firewall.counts - counts == {name: 1}
    router.firewall.measure("ground", Traffic(10**6, 0), now + 1)
    assert router.firewall.counts["floods"] == 1
    assert all(router.pass_on(*each) for each in packets[middle:])  # the pilot is not disturbed


def test_a_second_sender_of_telemetry_is_found():
    router, attacker = Router(), Sender(1, 1)
    found = []
    for packet, now in flight(Firmware.PX4)[:4000]:
        router.pass_on(packet, now)
        router.firewall.decide("vehicle", attacker.packet(common.Attitude()), now)
        found += router.detectors()
    assert set(found) == {"sequence"}
