from __future__ import annotations

import pytest

from mavstack.msp.messages.gps import CompGps
from mavstack.msp.messages.navigation import (
    LAST_WAYPOINT_FLAG,
    GetWp,
    NavError,
    NavMode,
    NavState,
    NavStatus,
    SetWp,
    WaypointAction,
    Wp,
    WpInfo,
    WpMissionLoad,
    WpMissionSave,
)
from mavstack.msp.messages.sensors import Altitude
from mavstack.sim.motion import LocalFrame
from tests.sim.msp.peer import HIGH, LOW, MIDDLE, Peer


class Pilot(Peer):
    """A peer that flies iNav: switches by name, and waypoints in metres."""

    def __init__(self) -> None:
        super().__init__("inav")
        home = self.controller.body.home
        self.frame = LocalFrame(home.latitude, home.longitude, home.altitude)

    def waypoint(
        self,
        number: int,
        action: int,
        place: tuple[float, float, float],
        *parameters: int,
        last: bool = False,
    ) -> bool:
        """Write a waypoint at metres north, east and up."""
        north, east, up = place
        latitude, longitude, _ = self.frame.to_global(north, east, 0.0)
        p1, p2, p3 = (*parameters, 0, 0, 0)[:3]
        flag = LAST_WAYPOINT_FLAG if last else 0
        return self.write(SetWp(number, WaypointAction(action), latitude, longitude, up, p1, p2, p3, flag))

    def fly_until(self, reached, limit: float = 90.0, throttle: int = MIDDLE) -> None:
        """Transmit until a condition is met."""
        end = self.simulation.elapsed + limit
        while not reached():
            self.transmit(0.5, throttle=throttle)
            assert self.simulation.elapsed < end, self.get(NavStatus)

    def state(self) -> NavState:
        return self.get(NavStatus).state

    def climb(self) -> None:
        """Arm, climb in angle mode, and hold the position."""
        self.arm()
        self.aux[1] = HIGH
        self.transmit(2.5, throttle=1650)
        self.aux[2] = MIDDLE
        self.transmit(3.0, throttle=MIDDLE)


@pytest.fixture
def pilot():
    return Pilot()


def test_waypoints_are_written_in_order_while_disarmed(pilot):
    assert pilot.waypoint(1, WaypointAction.WAYPOINT, (10, 0, 5))
    assert not pilot.waypoint(3, WaypointAction.WAYPOINT, (10, 0, 5))
    assert pilot.get(WpInfo) == WpInfo(0, 120, False, 1)
    assert pilot.waypoint(2, WaypointAction.LAND, (0, 0, 5), last=True)
    assert pilot.get(WpInfo).is_valid
    read = pilot.get(Wp, GetWp(1).encode())
    assert (read.index, read.action, read.altitude) == (1, WaypointAction.WAYPOINT, 5)
    assert pilot.get(Wp, GetWp(9).encode()).action is WaypointAction.RTH
    pilot.arm()
    assert not pilot.waypoint(1, WaypointAction.WAYPOINT, (10, 0, 5))


def test_home_and_the_own_position_are_waypoints(pilot):
    pilot.run(1.0)
    home = pilot.controller.body.home
    for number in (0, 255):
        waypoint = pilot.get(Wp, GetWp(number).encode())
        assert waypoint.latitude == pytest.approx(home.latitude, abs=1e-4)
        assert waypoint.altitude == pytest.approx(home.altitude, abs=2)


def test_a_saved_mission_outlives_a_reboot_and_is_loaded(pilot):
    assert not pilot.write(WpMissionSave())
    assert not pilot.write(WpMissionLoad())
    pilot.waypoint(1, WaypointAction.WAYPOINT, (10, 0, 5), last=True)
    assert pilot.write(WpMissionSave())
    pilot.controller.reboot()
    pilot.run(1.5)
    assert pilot.get(WpInfo).waypoint_count == 0
    assert pilot.write(WpMissionLoad())
    assert pilot.get(WpInfo) == WpInfo(0, 120, True, 1)


def test_an_action_that_inav_does_not_take_changes_nothing(pilot):
    pilot.waypoint(1, WaypointAction.WAYPOINT, (10, 0, 5), last=True)
    assert not pilot.write(
        SetWp(1, WaypointAction.POSHOLD_UNLIMITED, 47.0, 8.0, 5.0, 0, 0, 0, LAST_WAYPOINT_FLAG)
    )
    assert pilot.get(Wp, GetWp(1).encode()).action == WaypointAction.WAYPOINT


def test_a_mission_that_is_far_away_forbids_arming(pilot):
    pilot.transmit(1.5)
    pilot.waypoint(1, WaypointAction.WAYPOINT, (500, 0, 5), last=True)
    pilot.transmit(0.1)
    assert pilot.controller.arming_disable_reasons == ("NAVIGATION_UNSAFE",)


@pytest.mark.flight
def test_a_mission_is_flown_with_its_jump_hold_and_return(pilot):
    pilot.waypoint(1, WaypointAction.WAYPOINT, (20, 0, 8))
    pilot.waypoint(2, WaypointAction.POSHOLD_TIME, (20, 15, 10), 2)
    pilot.waypoint(3, WaypointAction.JUMP, (0, 0, 0), 1, 1)
    pilot.waypoint(4, WaypointAction.RTH, (0, 0, 0), 1, last=True)
    pilot.arm()
    pilot.aux[2] = HIGH
    pilot.transmit(1.0)
    assert pilot.controller.body.on_ground  # until the throttle is raised
    pilot.fly_until(lambda: pilot.state() is NavState.HOLD_TIMED)
    status = pilot.get(NavStatus)
    assert (status.mode, status.waypoint, status.error) == (NavMode.NAV, 2, NavError.TIME_WAIT)
    assert pilot.get(Altitude).altitude == pytest.approx(10, abs=1.5)
    assert not pilot.write(WpMissionSave())
    pilot.fly_until(lambda: pilot.state() is NavState.LANDED)
    assert pilot.texts("mission") == [f"waypoint {number} reached" for number in (1, 2, 1, 2)]
    assert pilot.get(CompGps).distance_to_home < 4
    pilot.aux[0] = LOW
    pilot.transmit(0.1)
    assert not pilot.controller.armed


@pytest.mark.flight
def test_position_hold_follows_the_sticks_and_a_ground_station(pilot):
    pilot.climb()
    status = pilot.get(NavStatus)
    assert (status.mode, status.state) == (NavMode.HOLD, NavState.HOLD_INFINITE)
    before = pilot.controller.body.truth
    pilot.transmit(3.0, throttle=MIDDLE, pitch=1700)
    assert pilot.controller.body.truth.north - before.north > 3
    assert not pilot.waypoint(255, WaypointAction.WAYPOINT, (0, 20, 12))
    pilot.aux[5] = HIGH  # GCS NAV
    pilot.transmit(0.1, throttle=MIDDLE)
    assert pilot.waypoint(255, WaypointAction.WAYPOINT, (0, 20, 12))
    pilot.transmit(12.0, throttle=MIDDLE)
    assert pilot.controller.body.truth.east == pytest.approx(20, abs=2)
    assert pilot.get(Altitude).altitude == pytest.approx(12, abs=2)


@pytest.mark.flight
def test_a_lost_signal_returns_home_by_the_procedure_rth(pilot):
    pilot.enter_cli()
    pilot.cli("set failsafe_procedure = RTH")
    pilot.cli("save")
    pilot.run(1.5)
    pilot.climb()
    pilot.transmit(4.0, throttle=MIDDLE, pitch=1900)
    assert pilot.get(CompGps).distance_to_home > 8
    pilot.run(3.0)
    assert pilot.controller.mode == "FAILSAFE"
    assert pilot.get(NavStatus).mode is NavMode.RTH
    for _ in range(60):
        pilot.run(1.0)
    assert not pilot.controller.armed
    assert pilot.get(CompGps).distance_to_home < 4
