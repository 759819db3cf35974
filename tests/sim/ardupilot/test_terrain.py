"""Terrain of simulated ArduPilot vehicles: requests, reports, and missions above the terrain."""

from __future__ import annotations

from math import sin

import pytest

from mavstack.dialects import common
from mavstack.services.message_request.interval import message_id_of
from mavstack.services.mission import MissionItem
from mavstack.services.terrain import TerrainServer, locate
from tests.sim.harness import CMD, GROUND, SimulationHarness, VehicleHarness

FRAME = common.MavFrame
TERRAIN_BIT = common.MavSysStatusSensor.TERRAIN


def hills(latitude: float, longitude: float) -> float:
    """Return a height in metres, with hills of 30 m north of home; a tenth is the steepest slope."""
    return 500.0 + 30.0 * sin((latitude - 47.3977) * 370.0)


class Served(VehicleHarness):
    """A vehicle that asks for terrain, and a ground station that serves it."""

    serves = True
    requests = 0
    server = TerrainServer(GROUND, hills)

    def collect(self, data: bytes) -> None:
        for packet in self._parser.feed(data):
            self.received.append(packet.message)
            if isinstance(packet.message, common.TerrainRequest):
                self.requests += 1
                if self.serves:
                    self.server.receive(packet, self.vehicle.now)

    def deliver(self) -> None:
        """Send the tiles that the vehicle asked for."""
        for outgoing in self.server.messages_to_send(self.vehicle.now):
            self.send(outgoing.message)

    def load_terrain(self) -> Served:
        """Run until the vehicle has all the terrain that it wants."""
        terrain = self.vehicle.terrain
        self.run_until(lambda: terrain.loaded and not terrain.pending, each=self.deliver, timeout=120)
        self.run(3, self.deliver)
        assert not terrain.pending
        return self

    def report(self, latitude: float, longitude: float) -> common.TerrainReport:
        """Return the answer to TERRAIN_CHECK."""
        self.received.clear()
        self.send(common.TerrainCheck(round(latitude * 1e7), round(longitude * 1e7)))
        self.run(0.1)
        return self.received_of(common.TerrainReport)[-1]

    def place(self, north: float, east: float = 0.0) -> tuple[float, float]:
        latitude, longitude, _ = self.vehicle.body.frame.to_global(north, east, 0.0)
        return latitude, longitude


def vehicle(
    kind: str = "copter", firmware: str = "ardupilot", *, terrain: str = "request", **parameters: float
) -> Served:
    harness = SimulationHarness()
    one = harness.attach(Served(harness, harness.simulation.add(kind, firmware, terrain=terrain)))
    assert one.port
    return one.set(**parameters).without_telemetry()


def waypoint(one: Served, north: float, height: float) -> MissionItem:
    latitude, longitude = one.place(north)
    frame = FRAME.GLOBAL_TERRAIN_ALT
    return MissionItem(CMD.NAV_WAYPOINT, param5=latitude, param6=longitude, param7=height, frame=frame)


def test_the_terrain_around_the_vehicle_is_requested_own_block_first():
    one = vehicle().run(30)
    requests = one.received_of(common.TerrainRequest)
    assert 5 <= len(requests) <= 15
    assert {each.grid_spacing for each in requests} == {100}
    own = locate(*one.place(0), 100).block  # type: ignore[call-arg]
    assert {(each.lat, each.lon) for each in requests} == {own[:2]}
    one.load_terrain()
    here = one.place(0)
    assert one.vehicle.terrain.height(*here) == pytest.approx(hills(*here), abs=4)
    assert one.vehicle.terrain.loaded >= 4 * 56
    count = one.requests
    one.run(10)
    assert one.requests == count


@pytest.mark.parametrize(
    ("terrain", "firmware", "parameters"),
    [
        ("flat", "ardupilot", {}),
        ("request", "px4", {}),
        ("request", "ardupilot", {"TERRAIN_ENABLE": 0}),
        ("request", "ardupilot", {"TERRAIN_OPTIONS": 1}),
    ],
)
def test_no_requests_by_default_and_when_disabled(terrain, firmware, parameters):
    assert vehicle("copter", firmware, terrain=terrain, **parameters).run(30).requests == 0


def test_the_report_counts_tiles_and_follows_the_vehicle():
    one = vehicle().run(30)
    report = one.report(*one.place(0))
    assert (report.spacing, report.terrain_height, report.loaded) == (0, 0.0, 0)
    assert report.pending > 0
    one.load_terrain()
    terrain = one.vehicle.terrain
    report = one.report(*one.place(300))
    assert (report.spacing, report.pending, report.loaded) == (100, 0, terrain.loaded)
    assert report.terrain_height == pytest.approx(hills(*one.place(300)), abs=5)
    difference = terrain.height(*one.place(300)) - terrain.height(*one.place(0))
    assert report.current_height == pytest.approx(-difference, abs=1)
    streamed = one.command(CMD.REQUEST_MESSAGE, message_id_of(common.TerrainReport))
    assert streamed == common.MavResult.ACCEPTED
    assert one.received_of(common.TerrainReport)[-1].current_height == pytest.approx(0, abs=1)


def test_a_check_makes_the_vehicle_ask_for_that_terrain():
    one = vehicle().run(30).load_terrain()
    far = one.place(20_000)
    report = one.report(*far)
    assert (report.spacing, report.pending) == (0, 56)
    assert (report.lat, report.lon) == (round(far[0] * 1e7), round(far[1] * 1e7))
    one.load_terrain()
    assert one.report(*far).spacing == 100


def test_the_flat_ground_is_known_everywhere():
    one = vehicle(terrain="flat").run(1)
    report = one.report(*one.place(20_000))
    assert (report.spacing, report.terrain_height, report.pending) == (100, 488.0, 0)
    assert vehicle("copter", "px4").run(1).received_of(common.TerrainReport) == []


def test_the_terrain_of_waypoints_is_requested():
    one = vehicle().run(30)
    one.load(waypoint(one, 9000, 20), waypoint(one, 15_000, 20)).load_terrain()
    for north in (8500, 9000, 9500, 15_000):
        assert one.vehicle.terrain.height(*one.place(north)) is not None
    assert one.vehicle.terrain.height(*one.place(12_000)) is None


def test_the_map_survives_a_reboot_and_not_another_spacing():
    one = vehicle().run(30).load_terrain()
    one.vehicle.reboot()
    one.run(2)
    assert one.report(*one.place(0)).spacing == 100
    one.set(TERRAIN_SPACING=50).received.clear()
    one.run(3)
    assert one.received_of(common.TerrainRequest)[0].grid_spacing == 50
    assert one.vehicle.terrain.loaded == 0


def test_capability_and_health_report_the_terrain():
    one = vehicle().run(30)
    one.command(CMD.REQUEST_MESSAGE, message_id_of(common.AutopilotVersion))
    flag = common.MavProtocolCapability.TERRAIN
    assert one.received_of(common.AutopilotVersion)[-1].capabilities & flag
    one.command(CMD.REQUEST_MESSAGE, message_id_of(common.SysStatus))
    status = one.received_of(common.SysStatus)[-1]
    assert status.onboard_control_sensors_present & TERRAIN_BIT
    assert not status.onboard_control_sensors_health & TERRAIN_BIT
    one.load_terrain()
    one.command(CMD.REQUEST_MESSAGE, message_id_of(common.SysStatus))
    assert one.received_of(common.SysStatus)[-1].onboard_control_sensors_health & TERRAIN_BIT


def test_a_mission_above_unknown_terrain_prevents_arming():
    one = vehicle().run(30)
    one.load(waypoint(one, 300, 20))
    assert "Arm: waiting for terrain data" in one.autopilot.arm()
    one.load_terrain()
    assert one.autopilot.arm() == []
    one.autopilot.disarm("test")
    one.set(TERRAIN_ENABLE=0)
    assert "Arm: terrain disabled" in one.autopilot.arm()


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize(("kind", "leg", "error"), [("copter", 300, 2), ("plane", 600, 10)])
def test_a_mission_follows_the_terrain(kind, leg, error):
    one = vehicle(kind).run(30).load_terrain()
    one.load(*(waypoint(one, leg * number, 40) for number in (1, 2, 3, 4)))
    one.load_terrain().place_in_air("AUTO")
    terrain, body = one.vehicle.terrain, one.vehicle.body
    home, heights, flown = terrain.height(*one.place(0)), {}, []

    def measure() -> None:
        ground = terrain.height(*one.place(body.truth.north, body.truth.east)) - home
        heights[body.truth.north] = -body.truth.down - ground
        flown.append(-body.truth.down)

    one.run_until(lambda: body.truth.north > 3 * leg, timeout=240, each=measure)
    on_the_way = [height for north, height in heights.items() if north > 1.5 * leg]
    assert min(on_the_way) > 40 - error
    assert max(on_the_way) < 40 + error
    assert max(flown) - min(flown) > 10


def test_a_copter_that_lacks_the_terrain_of_its_mission_returns():
    one = vehicle().run(30).load_terrain()
    one.load(*(waypoint(one, 300 * number, 40) for number in (1, 2, 3, 4)))
    one.load_terrain().place_in_air("AUTO").run(3)
    one.serves = False
    one.vehicle.terrain.clear()
    one.run(4)
    assert one.mode == "AUTO"
    one.run_until(lambda: one.mode == "RTL", timeout=10)
    assert any(
        message.text == "Failsafe: Terrain data missing" for message in one.received_of(common.Statustext)
    )


def test_a_mission_above_home_needs_no_terrain():
    one = vehicle().run(30).load_terrain()
    latitude, longitude = one.place(900)
    frame = FRAME.GLOBAL_RELATIVE_ALT
    one.load(MissionItem(CMD.NAV_WAYPOINT, param5=latitude, param6=longitude, param7=40.0, frame=frame))
    one.place_in_air("AUTO").run(3)
    one.serves = False
    one.vehicle.terrain.clear()
    one.run(12)
    assert one.mode == "AUTO"
