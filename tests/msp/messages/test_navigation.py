"""Messages of iNav: the sizes that its reference of MSP tells, and waypoints byte by byte."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.msp import FirmwareInfo
from mavstack.msp.messages import (
    battery,
    blackbox,
    filters,
    gps,
    motors,
    navigation,
    osd,
    rc,
    sensors,
    status,
)
from mavstack.msp.messages.navigation import (
    LAST_WAYPOINT_FLAG,
    NavMode,
    NavState,
    NavStatus,
    SetWp,
    WaypointAction,
    Wp,
)

if TYPE_CHECKING:
    from mavstack.msp.messages.layout import TableMessage

INAV = FirmwareInfo("INAV", (8, 0, 0), (2, 5))
SIZES: dict[type[TableMessage], int] = {
    navigation.NavPoshold: 13,
    navigation.RthAndLandConfig: 21,
    navigation.FwConfig: 12,
    navigation.PositionEstimationConfig: 12,
    navigation.Wp: 21,
    navigation.NavStatus: 7,
    navigation.Safehome: 10,
    navigation.FullLocalPose: 24,
    navigation.InavMisc2: 10,
    rc.InavRateProfile: 15,
    rc.FailsafeConfig: 20,
    rc.RxConfig: 24,
    rc.SetRcTuning: 11,
    battery.InavBatteryConfig: 29,
    battery.InavAnalog: 24,
    battery.BatteryState: 11,
    battery.Analog: 7,
    motors.InavMixer: 9,
    motors.SetServoConfiguration: 15,
    motors.SetServoMixRule: 9,
    blackbox.SetInavBlackboxConfig: 9,
    gps.SetRawGps: 14,
    gps.RawGps: 18,
    gps.GpsStatistics: 21,
    osd.SetInavOsdItem: 4,
    osd.SetOsdItem: 3,
    filters.AdvancedConfig: 9,
    filters.FilterConfig: 23,
    sensors.SensorConfig: 6,
    sensors.Altitude: 10,
    status.StatusEx: 16,
    status.SensorStatus: 9,
}


@pytest.mark.parametrize("message", SIZES, ids=lambda message: message.__name__)
def test_sizes_of_payloads(message: type[TableMessage]) -> None:
    size = SIZES[message]
    assert len(message.decode(bytes(size), INAV).encode(INAV)) == size
    assert len(message.decode(bytes(size + 8), INAV).encode(INAV)) == size


def test_a_waypoint() -> None:
    waypoint = Wp(3, WaypointAction.WAYPOINT, 47.397742, 8.545594, 50.0, 500, 0, 1, LAST_WAYPOINT_FLAG)
    payload = bytes.fromhex("03 01 4c52401c 44f41705 88130000 f401 0000 0100 a5")
    assert waypoint.encode(INAV) == payload
    assert Wp.decode(payload, INAV) == waypoint
    assert SetWp.from_message(waypoint).encode(INAV) == payload
    assert (Wp.COMMAND, SetWp.COMMAND) == (118, 209)


def test_state_of_the_navigation() -> None:
    state = NavStatus.decode(bytes.fromhex("03 05 01 02 00 5a00"), INAV)
    assert (state.mode, state.state, state.waypoint, state.target_heading) == (
        NavMode.NAV,
        NavState.WP_ENROUTE,
        2,
        90,
    )
