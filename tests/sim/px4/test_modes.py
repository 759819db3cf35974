"""PX4's modes: how they are listed, which flags they have, who may enter them."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.modes.names import px4_modes_of
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.px4.pilot import CMD, RESULT, Pilot

STANDARD, PROPERTY = common.MavStandardMode, common.MavModeProperty
#: As SITL of PX4 lists them: main and sub mode to name, "" for standard modes.
NAMES = {
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
    (3, 1): "",
}
TELEMETRY = Address(254, 1)


@pytest.fixture(scope="module")
def copter() -> Pilot:
    return Pilot()


def test_available_modes_are_listed_as_px4_lists_them(copter: Pilot) -> None:
    listed = copter.request(common.AvailableModes, 0)
    found = {px4_modes_of(mode.custom_mode): mode.mode_name for mode in listed}
    assert found == NAMES
    assert [px4_modes_of(mode.custom_mode) for mode in listed] == list(NAMES)
    hold = next(mode for mode in listed if mode.mode_name == "Hold")
    assert hold.properties == PROPERTY.ADVANCED
    orbit = next(mode for mode in listed if mode.standard_mode == STANDARD.ORBIT)
    assert orbit.properties == PROPERTY.ADVANCED
    descend = next(mode for mode in listed if mode.mode_name == "Descend")
    assert descend.properties & PROPERTY.NOT_USER_SELECTABLE
    position = next(mode for mode in listed if mode.standard_mode == STANDARD.POSITION_HOLD)
    assert position.properties == 0


@pytest.mark.parametrize("kind", list(VehicleType))
def test_a_type_has_the_modes_that_it_can_fly(kind: VehicleType) -> None:
    pilot = Pilot(kind.value, ready=False)
    names = {mode.name for mode in pilot.vehicle.profile.modes}
    assert {"Manual", "Position", "Hold", "Mission", "Return", "Offboard", "Acro", "Stabilized"} <= names
    assert ("Takeoff" in names) == ("Land" in names) == ("Orbit" in names) == kind.flies
    assert ("VTOL Takeoff" in names) == (kind is VehicleType.VTOL)
    assert ("Altitude" in names) == (not kind.on_surface)


@pytest.mark.parametrize(
    ("kind", "standard"),
    [
        ("copter", STANDARD.POSITION_HOLD),
        ("plane", STANDARD.CRUISE),
        ("vtol", STANDARD.NON_STANDARD),
        ("rover", STANDARD.NON_STANDARD),
    ],
)
def test_position_mode_is_another_standard_mode_for_each_type(kind: str, standard: int) -> None:
    modes = Pilot(kind, ready=False).vehicle.profile.modes
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
def test_heartbeat_has_the_flags_that_px4_sets(copter: Pilot, main: int, sub: int, flags: int) -> None:
    assert copter.set_mode(main, sub) == RESULT.ACCEPTED
    copter.run(1.2)
    assert copter.heartbeat[:2] == (flags, (main, sub))


def test_it_boots_in_hold_and_is_uninitialised_until_it_is_ready() -> None:
    pilot = Pilot(ready=False)
    pilot.run(1.0)
    assert pilot.heartbeat == (0b11101, (4, 3), int(common.MavState.UNINIT))
    pilot.run(4.0)
    assert pilot.heartbeat == (0b11101, (4, 3), int(common.MavState.STANDBY))


def test_disarmed_any_mode_may_be_chosen_and_armed_only_what_can_be_flown() -> None:
    pilot = Pilot()
    assert pilot.set_mode(1) == RESULT.ACCEPTED
    assert pilot.set_mode(4, 3) == RESULT.ACCEPTED
    pilot.in_the_air()
    for main, name in ((1, "Manual"), (2, "Altitude"), (3, "Position"), (5, "Acro"), (6, "Offboard")):
        assert pilot.set_mode(main) == RESULT.TEMPORARILY_REJECTED
        assert pilot.texts[-1] == f"Switching to {name} is currently not available"
    assert pilot.set_mode(4, 4) == RESULT.TEMPORARILY_REJECTED
    assert pilot.mode == "Hold"


def test_only_ground_stations_are_told_why() -> None:
    pilot = Pilot().in_the_air()
    said = len(pilot.texts)
    assert pilot.set_mode(6, source=TELEMETRY) == RESULT.TEMPORARILY_REJECTED
    assert pilot.texts[said:] == []


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
def test_what_is_no_mode_is_rejected_with_its_text(
    copter: Pilot, params: tuple[float, ...], text: str
) -> None:
    assert copter.command(CMD.DO_SET_MODE, *params) == RESULT.TEMPORARILY_REJECTED
    assert copter.texts[-1] == text


def test_auto_without_a_sub_mode_is_mission(copter: Pilot) -> None:
    assert copter.set_mode(4, 0) == RESULT.ACCEPTED
    assert copter.mode == "Mission"


@pytest.mark.parametrize(
    ("flags", "name"), [(4, "Mission"), (64, "Manual"), (64 | 16, "Stabilized"), (64 | 8, "Position")]
)
def test_modes_may_be_chosen_by_flags(copter: Pilot, flags: int, name: str) -> None:
    assert copter.command(CMD.DO_SET_MODE, flags) == RESULT.ACCEPTED
    assert copter.mode == name


def test_standard_modes_are_entered_and_told_as_intended(copter: Pilot) -> None:
    assert copter.command(CMD.DO_SET_STANDARD_MODE, STANDARD.SAFE_RECOVERY) == RESULT.ACCEPTED
    (current,) = copter.request(common.CurrentMode)[:1]
    assert px4_modes_of(current.custom_mode) == px4_modes_of(current.intended_custom_mode) == (4, 5)
    assert current.standard_mode == STANDARD.SAFE_RECOVERY
    assert copter.command(CMD.DO_SET_STANDARD_MODE, STANDARD.CRUISE) == RESULT.FAILED
    assert copter.command(CMD.DO_SET_STANDARD_MODE, 200) == RESULT.FAILED


def test_set_mode_message_works_as_the_command_does(copter: Pilot) -> None:
    copter.set_mode(4, 3)
    wanted = 7 << 16
    copter.send(common.SetMode(target_system=1, base_mode=1, custom_mode=wanted))
    assert copter.mode == "Stabilized"
    copter.set_mode(4, 3)


def test_with_sticks_the_pilots_modes_may_be_entered() -> None:
    pilot = Pilot().in_the_air()

    def hold_sticks() -> None:
        pilot.send(common.ManualControl(target=1, x=0, y=0, z=500, r=0))

    pilot.run(1.0, hold_sticks)
    assert pilot.set_mode(3) == RESULT.ACCEPTED
    pilot.run(3.0, hold_sticks)
    assert pilot.mode == "Position"
    assert pilot.height > 10
