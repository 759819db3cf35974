"""The pilot's hands: the transmitter, overridden channels, MANUAL_CONTROL, and the switches of ArduPilot."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.sim.autopilot.radio import Sticks
from tests.sim.harness import VehicleHarness, airborne, grounded

IGNORE = 0xFFFF


def override(one: VehicleHarness, source: Address | None = None, **channels: int) -> None:
    values = {f"chan{channel}_raw": IGNORE for channel in range(1, 9)}
    values |= {f"chan{name[1:]}_raw": value for name, value in channels.items()}
    one.send(common.RcChannelsOverride(target_system=1, target_component=1, **values), source)


def sticks(one: VehicleHarness, source: Address | None = None, **axes: int) -> None:
    fields = {"x": 0, "y": 0, "z": 500, "r": 0} | axes
    one.send(common.ManualControl(target=1, **fields), source)


def test_the_transmitter_lies_there_with_its_sticks_centred_and_the_throttle_closed() -> None:
    for kind, throttle in (("copter", 0.0), ("plane", 0.0), ("rover", 0.5), ("sub", 0.5)):
        radio = grounded(kind, seconds=0.2).autopilot.radio
        assert radio.present
        assert radio.sticks == Sticks(0, 0, throttle, 0)
        assert radio.rssi == 254
        assert len(radio.channels) == 18


def test_a_px4_has_no_radio_until_manual_control_arrives() -> None:
    one = grounded("copter", "px4", seconds=0.2)
    radio = one.autopilot.radio
    assert not radio.present
    assert radio.rssi == 255
    assert set(radio.channels) == {0}
    sticks(one, y=500)
    assert radio.present
    assert radio.sticks.roll == pytest.approx(0.5)
    one.run(1.5)
    assert not radio.present
    assert radio.was_present


@pytest.mark.parametrize(("firmware", "pulled"), [("ardupilot", 1750), ("px4", 1250)])
def test_sticks_mean_the_same_by_channels_and_by_manual_control(firmware: str, pulled: int) -> None:
    one = grounded("copter", firmware, seconds=0.2)
    radio = one.autopilot.radio
    override(one, c1=1750, c2=pulled, c3=1600, c4=1000)
    by_channels = radio.sticks
    assert by_channels == pytest.approx((0.5, 0.5, 0.6, -1.0))
    sticks(one, y=500, x=-500, z=600, r=-1000)
    assert radio.sticks == pytest.approx(by_channels)


def test_pulses_beyond_the_ends_are_at_the_ends() -> None:
    one = grounded(seconds=0.2)
    override(one, c1=2500, c2=2500)
    assert one.autopilot.radio.sticks[:2] == (1.0, 1.0)


def test_overridden_channels_add_up_and_are_released_one_by_one_and_by_silence() -> None:
    one = grounded(seconds=0.2)
    radio = one.autopilot.radio
    override(one, c1=1600)
    override(one, c4=1400)
    assert (radio.channels[0], radio.channels[3]) == (1600, 1400)
    override(one, c1=0)
    assert (radio.channels[0], radio.channels[3]) == (1500, 1400)
    override(one, c4=0)
    assert radio.channels[3] == 1500
    override(one, c1=1600)
    one.run(3.5)
    assert radio.channels[0] == 1500


def test_with_the_transmitter_off_overridden_channels_are_all_there_is() -> None:
    one = grounded(seconds=0.2).inject("radio off")
    radio = one.autopilot.radio
    assert not radio.present
    assert radio.rssi == 0
    assert set(radio.channels) == {0}
    override(one, c3=1700)
    assert radio.present
    assert radio.channels[2] == 1700
    one.inject("radio on")
    assert radio.present
    assert radio.channels[0] == 1500


def test_an_ardupilot_listens_only_to_the_station_of_sysid_mygcs() -> None:
    one = grounded(seconds=0.2)
    other_station = Address(200, 1)
    override(one, other_station, c1=1900)
    sticks(one, other_station, y=900)
    assert one.autopilot.radio.sticks.roll == 0
    one.set(SYSID_MYGCS=200)
    sticks(one, other_station, y=900)
    assert one.autopilot.radio.sticks.roll == pytest.approx(0.9)


def test_a_px4_accepts_manual_control_from_any_source() -> None:
    one = grounded("copter", "px4", seconds=0.2)
    sticks(one, Address(200, 1), y=900)
    assert one.autopilot.radio.sticks.roll == pytest.approx(0.9)


def test_axes_that_are_not_there_are_centred() -> None:
    one = grounded(seconds=0.2)
    sticks(one, x=0x7FFF, y=0x7FFF, z=0x7FFF, r=0x7FFF)
    assert one.autopilot.radio.sticks == (0, 0, 0.5, 0)


# Hands that fly


@pytest.mark.flight
def test_sticks_fly_a_copter_and_let_go_of_it() -> None:
    copter = airborne(mode="LOITER")
    copter.repeated_message = lambda: common.ManualControl(target=1, x=500, y=0, z=500, r=0)
    copter.run(4)
    assert copter.vehicle.body.truth.velocity_north > 1, "stick forward"
    copter.repeated_message = None
    copter.autopilot.radio.move(3, 1500)
    copter.run(6)
    assert abs(copter.vehicle.body.truth.velocity_north) < 0.3
    copter.repeated_message = lambda: common.ManualControl(target=1, x=0, y=0, z=900, r=0)
    before = copter.height
    copter.run(3)
    assert copter.height > before + 1


@pytest.mark.flight
def test_channels_drive_a_rover() -> None:
    rover = airborne("rover", mode="MANUAL")
    rover.repeated_message = lambda: common.RcChannelsOverride(
        target_system=1, target_component=1, chan1_raw=1500, chan3_raw=1800,
        **{f"chan{number}_raw": IGNORE for number in (2, 4, 5, 6, 7, 8)},
    )  # fmt: skip
    rover.run(3)
    assert rover.vehicle.body.truth.velocity_north > 1


@pytest.mark.flight
def test_sticks_fly_a_px4_in_position_mode() -> None:
    copter = airborne("copter", "px4")
    copter.repeated_message = lambda: common.ManualControl(target=1, x=0, y=600, z=500, r=0)
    copter.enter("Position").run(4)
    assert copter.vehicle.body.truth.velocity_east > 1


@pytest.mark.flight
def test_when_the_hands_cease_the_radio_failsafe_acts() -> None:
    copter = airborne(mode="ALT_HOLD", FS_THR_ENABLE=1).inject("radio off")
    copter.repeated_message = lambda: common.RcChannelsOverride(
        target_system=1, target_component=1, chan1_raw=1500, chan2_raw=1500, chan3_raw=1500, chan4_raw=1500,
        **{f"chan{number}_raw": IGNORE for number in (5, 6, 7, 8)},
    )  # fmt: skip
    copter.run(2)
    copter.enter("ALT_HOLD").run(3)
    assert copter.mode == "ALT_HOLD"
    copter.repeated_message = None
    copter.run(5)
    assert copter.mode == "RTL"


# Switches


@pytest.mark.parametrize(
    ("kind", "channel", "name"),
    [("copter", "FLTMODE_CH", "FLTMODE"), ("plane", "FLTMODE_CH", "FLTMODE"), ("rover", "MODE_CH", "MODE")],
)
def test_the_mode_switch_has_six_positions(kind, channel, name) -> None:
    one = grounded(kind)
    modes = one.vehicle.profile.modes
    mission = one.vehicle.profile.mission
    wanted = [mode for mode in modes if mode.number != mission and mode.name != "FOLLOW"][:6]
    for position, mode in enumerate(wanted, 1):
        one.set(**{f"{name}{position}": mode.number})
    number = int(one.vehicle.parameters[channel])
    one.run(0.2)
    for pulse, mode in zip((1100, 1300, 1400, 1550, 1700, 1900), wanted, strict=True):
        one.autopilot.radio.move(number, pulse)
        one.run(0.2)
        assert one.mode == mode.name
    override(one, **{f"c{number}": 1300})
    one.run(0.2)
    assert one.mode == wanted[1].name, "overridden, too"


def test_where_the_switch_stands_at_first_changes_nothing() -> None:
    copter = grounded(FLTMODE6=5)
    assert copter.mode == "STABILIZE"
    copter.enter("GUIDED").run(1)
    assert copter.mode == "GUIDED", "only a switch that moves counts"


@pytest.mark.flight
def test_a_mode_that_cannot_be_entered_is_explained() -> None:
    copter = airborne(FLTMODE1=5).inject("gps off").run(7)
    copter.autopilot.radio.move(5, 1100)
    copter.run(0.2)
    assert "Mode change to LOITER failed: requires position" in copter.texts


def test_a_channel_with_an_option_is_a_switch() -> None:
    copter = airborne(RC9_OPTION=4, RC10_OPTION=19)
    copter.autopilot.payload.grip(closed=True)
    for channel in (9, 10):
        copter.autopilot.radio.move(channel, 1100)
    copter.run(0.2)
    copter.autopilot.radio.move(9, 1900)
    copter.run(0.2)
    assert copter.mode == "RTL"
    copter.autopilot.radio.move(10, 1900)
    copter.run(0.2)
    copter.autopilot.radio.move(10, 1100)
    copter.run(0.2)
    assert not copter.autopilot.payload.gripper_closed
