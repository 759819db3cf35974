"""Mode names both ways, for each firmware, and against what pymavlink knows."""

from __future__ import annotations

import pytest
from pymavlink import mavutil

from mavstack.dialects import common
from mavstack.services.modes import (
    is_placeholder,
    mode_name,
    mode_names,
    mode_number,
    px4_custom_mode,
    px4_modes_of,
)

ARDUPILOT, PX4 = common.MavAutopilot.ARDUPILOTMEGA, common.MavAutopilot.PX4
T = common.MavType
#: pymavlink's names that are not the official enums'.
SAME = {
    "FBWA": "FLY_BY_WIRE_A",
    "FBWB": "FLY_BY_WIRE_B",
    "INITIALISING": "INITIALIZING",
    "LOITERALTQLAND": "LOITER_ALT_QLAND",
}
#: Modes long gone that pymavlink still names.
GONE = {"POSITION", "OF_LOITER", "LEARNING"}


@pytest.mark.parametrize("vehicle", sorted(mavutil.AP_MAV_TYPE_MODE_MAP_DEFAULT))
def test_ardupilot_modes_are_those_of_pymavlink(vehicle):
    for number, name in mavutil.AP_MAV_TYPE_MODE_MAP_DEFAULT[vehicle].items():
        if name in GONE:
            continue
        assert mode_number(ARDUPILOT, vehicle, name) == number
        assert mode_name(ARDUPILOT, vehicle, number) in (name, SAME.get(name))


@pytest.mark.parametrize("name", sorted(set(mavutil.px4_map) - {"RTGS"}))
def test_px4_modes_are_those_of_pymavlink(name):
    _, main, sub = mavutil.px4_map[name]
    assert mode_number(PX4, T.QUADROTOR, name) == px4_custom_mode(main, sub)


@pytest.mark.parametrize(("autopilot", "vehicle"), [(ARDUPILOT, kind) for kind in range(40)] + [(PX4, 2)])
def test_each_name_leads_back_to_its_number(autopilot, vehicle):
    names = mode_names(autopilot, vehicle)
    for number, name in names.items():
        assert mode_number(autopilot, vehicle, name) == number
        assert mode_name(autopilot, vehicle, number) == name


def test_the_same_number_is_another_mode_on_another_vehicle():
    assert mode_name(ARDUPILOT, T.QUADROTOR, 4) == "GUIDED"
    assert mode_name(ARDUPILOT, T.SURFACE_BOAT, 4) == "HOLD"
    assert mode_name(ARDUPILOT, T.FIXED_WING, 4) == "ACRO"
    assert mode_name(ARDUPILOT, T.AIRSHIP, 2) == "VELOCITY"
    assert mode_name(ARDUPILOT, T.VTOL_TILTROTOR, 19) == "QLOITER"


@pytest.mark.parametrize("text", ["alt_hold", "Alt Hold", "ALTHOLD", "alt-hold"])
def test_names_are_read_as_people_write_them(text):
    assert mode_number(ARDUPILOT, T.QUADROTOR, text) == 2


def test_px4_numbers_lie_in_the_two_upper_bytes():
    assert px4_custom_mode(4, 5) == 0x05040000
    assert px4_modes_of(0x05040000) == (4, 5)
    assert mode_name(PX4, T.QUADROTOR, px4_custom_mode(4, 12)) == "EXTERNAL2"
    assert mode_name(PX4, T.QUADROTOR, px4_custom_mode(3, 1)) == "ORBIT"


def test_a_px4_sub_mode_that_no_client_knows_has_its_main_modes_name():
    assert mode_name(PX4, T.QUADROTOR, px4_custom_mode(4, 99)) == "AUTO"
    assert mode_name(PX4, T.QUADROTOR, px4_custom_mode(99)) is None


def test_what_is_unknown_has_no_name():
    assert mode_name(ARDUPILOT, T.QUADROTOR, 99) is None
    assert mode_name(ARDUPILOT, T.GIMBAL, 1) is None
    assert mode_name(common.MavAutopilot.GENERIC, T.QUADROTOR, 1) is None
    assert mode_number(ARDUPILOT, T.QUADROTOR, "QLOITER") is None


@pytest.mark.parametrize(
    ("autopilot", "name", "expected"),
    [
        (PX4, "mode 17", True),
        (PX4, "Mode 17", True),
        (PX4, "EXTERNAL3", True),
        (PX4, "Reserved (5)", True),
        (PX4, "AUTO", True),
        (PX4, "READY", True),
        (PX4, "LOITER", False),
        (PX4, "Precision search", False),
        (ARDUPILOT, "INITIALIZING", True),
        (ARDUPILOT, "AUTO", False),
        (ARDUPILOT, "SIMPLE", False),
    ],
)
def test_placeholders_of_lists_of_modes(autopilot, name, expected):
    assert is_placeholder(autopilot, name) is expected
