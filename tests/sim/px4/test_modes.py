"""PX4's modes: list, HEARTBEAT flags, and who may enter them."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.modes.names import px4_modes_of
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.px4.harness import CMD, RESULT, Px4Harness

STANDARD_MODE, PROPERTY = common.MavStandardMode, common.MavModeProperty
#: Main and sub mode to name, in the order of PX4's SITL; "" for standard modes.
LISTED_MODES = {
    (1, 0): "Manual",
    (2, 0): "",
    (3, 0): "",
    (4, 4): "",
    (4, 3): "Hold",
    (4, 5): "",
    (5, 0): "Acro",
    (4, 20): "Descend",
    (10, 0): "Termination",
    (6, 0): "Offboard",
    (7, 0): "Stabilized",
    (4, 2): "",
    (4, 6): "",
    (4, 8): "Follow Target",
    (4, 9): "Precision Land",
    (3, 1): "",
}
TELEMETRY = Address(254, 1)


@pytest.fixture(scope="module")
def copter() -> Px4Harness:
    return Px4Harness()


def test_available_modes_are_listed_as_px4_lists_them(copter: Px4Harness) -> None:
    listed = copter.request(common.AvailableModes, 0)
    found = {px4_modes_of(mode.custom_mode): mode.mode_name for mode in listed}
    assert found == LISTED_MODES
    assert [px4_modes_of(mode.custom_mode) for mode in listed] == list(LISTED_MODES)
    hold = next(mode for mode in listed if mode.mode_name == "Hold")
    assert hold.properties == PROPERTY.ADVANCED
    orbit = next(mode for mode in listed if mode.standard_mode == STANDARD_MODE.ORBIT)
    assert orbit.properties == PROPERTY.ADVANCED
    descend = next(mode for mode in listed if mode.mode_name == "Descend")
    assert descend.properties & PROPERTY.NOT_USER_SELECTABLE
    position = next(mode for mode in listed if mode.standard_mode == STANDARD_MODE.POSITION_HOLD)
    assert position.properties == 0


@pytest.mark.parametrize("vehicle_type", list(VehicleType))
def test_modes_of_each_type(vehicle_type: VehicleType) -> None:
    harness = Px4Harness(vehicle_type.value, ready=False)
    names = {mode.name for mode in harness.vehicle.profile.modes}
    assert {"Manual", "Position", "Hold", "Mission", "Return", "Offboard", "Acro", "Stabilized"} <= names
    assert ("Takeoff" in names) == ("Land" in names) == ("Orbit" in names) == vehicle_type.flies
    assert ("VTOL Takeoff" in names) == (vehicle_type is VehicleType.VTOL)
    assert ("Altitude" in names) == (not vehicle_type.on_surface)


@pytest.mark.parametrize(
    ("vehicle_type", "standard"),
    [
        ("copter", STANDARD_MODE.POSITION_HOLD),
        ("plane", STANDARD_MODE.CRUISE),
        ("vtol", STANDARD_MODE.NON_STANDARD),
        ("rover", STANDARD_MODE.NON_STANDARD),
    ],
)
def test_standard_mode_of_position_by_type(vehicle_type: str, standard: int) -> None:
    modes = Px4Harness(vehicle_type, ready=False).vehicle.profile.modes
    assert next(mode for mode in modes if mode.name == "Position").available.standard_mode == standard


@pytest.mark.parametrize(
    ("main", "sub", "flags"),
    [
        (4, 3, 0b11101),
        (4, 4, 0b11101),
        (4, 5, 0b11101),
        (4, 2, 0b11101),
        (4, 6, 0b11101),
        (1, 0, 0b1010001),
        (2, 0, 0b1010001),
        (3, 0, 0b1010001),
        (5, 0, 0b1000001),
        (6, 0, 0b0010001),
        (7, 0, 0b1010001),
    ],
)
def test_heartbeat_has_the_flags_that_px4_sets(copter: Px4Harness, main: int, sub: int, flags: int) -> None:
    assert copter.set_mode(main, sub) == RESULT.ACCEPTED
    copter.run(1.2)
    assert copter.heartbeat[:2] == (flags, (main, sub))


def test_boots_in_hold_and_uninitialised() -> None:
    harness = Px4Harness(ready=False)
    harness.run(1.0)
    assert harness.heartbeat == (0b11101, (4, 3), int(common.MavState.UNINIT))
    harness.run(4.0)
    assert harness.heartbeat == (0b11101, (4, 3), int(common.MavState.STANDBY))


@pytest.mark.flight
def test_mode_selection_disarmed_and_armed() -> None:
    harness = Px4Harness()
    assert harness.set_mode(1) == RESULT.ACCEPTED
    assert harness.set_mode(4, 3) == RESULT.ACCEPTED
    harness.take_off()
    for main, name in ((1, "Manual"), (2, "Altitude"), (3, "Position"), (5, "Acro"), (6, "Offboard")):
        assert harness.set_mode(main) == RESULT.TEMPORARILY_REJECTED
        assert harness.texts[-1] == f"Switching to {name} is currently not available"
    assert harness.set_mode(4, 4) == RESULT.TEMPORARILY_REJECTED
    assert harness.mode == "Hold"


@pytest.mark.flight
def test_refusal_is_explained_to_ground_stations_only() -> None:
    harness = Px4Harness().take_off()
    sent = len(harness.texts)
    assert harness.set_mode(6, source=TELEMETRY) == RESULT.TEMPORARILY_REJECTED
    assert harness.texts[sent:] == []


@pytest.mark.parametrize(
    ("params", "text"),
    [
        ((1, 4, 10), "Unsupported auto mode"),
        ((1, 4, 20), "Unsupported auto mode"),
        ((1, 4, 77), "Unsupported auto mode"),
        ((1, 10, 0), "Unsupported main mode"),
        ((1, 99, 0), "Unsupported main mode"),
        ((0, 0, 0), "Unsupported base mode"),
    ],
)
def test_unknown_mode_is_rejected_with_a_text(
    copter: Px4Harness, params: tuple[float, ...], text: str
) -> None:
    assert copter.command(CMD.DO_SET_MODE, *params) == RESULT.TEMPORARILY_REJECTED
    assert copter.texts[-1] == text


def test_auto_without_a_sub_mode_is_mission(copter: Px4Harness) -> None:
    assert copter.set_mode(4, 0) == RESULT.ACCEPTED
    assert copter.mode == "Mission"


@pytest.mark.parametrize(
    ("flags", "name"), [(4, "Mission"), (64, "Manual"), (64 | 16, "Stabilized"), (64 | 8, "Position")]
)
def test_modes_by_flags(copter: Px4Harness, flags: int, name: str) -> None:
    assert copter.command(CMD.DO_SET_MODE, flags) == RESULT.ACCEPTED
    assert copter.mode == name


def test_standard_modes(copter: Px4Harness) -> None:
    assert copter.command(CMD.DO_SET_STANDARD_MODE, STANDARD_MODE.SAFE_RECOVERY) == RESULT.ACCEPTED
    (current,) = copter.request(common.CurrentMode)[:1]
    assert px4_modes_of(current.custom_mode) == px4_modes_of(current.intended_custom_mode) == (4, 5)
    assert current.standard_mode == STANDARD_MODE.SAFE_RECOVERY
    assert copter.command(CMD.DO_SET_STANDARD_MODE, STANDARD_MODE.CRUISE) == RESULT.FAILED
    assert copter.command(CMD.DO_SET_STANDARD_MODE, 200) == RESULT.FAILED


def test_set_mode_message(copter: Px4Harness) -> None:
    copter.set_mode(4, 3)
    wanted = 7 << 16
    copter.send(common.SetMode(target_system=1, base_mode=1, custom_mode=wanted))
    assert copter.mode == "Stabilized"
    copter.set_mode(4, 3)


@pytest.mark.flight
def test_manual_control_allows_the_pilots_modes() -> None:
    harness = Px4Harness().take_off()

    def hold_sticks() -> None:
        harness.send(common.ManualControl(target=1, x=0, y=0, z=500, r=0))

    harness.run(1.0, hold_sticks)
    assert harness.set_mode(3) == RESULT.ACCEPTED
    harness.run(3.0, hold_sticks)
    assert harness.mode == "Position"
    assert harness.height > 10
