"""The gimbal manager over a network: discovery, control, pointing, regions of interest."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionTimeout, CommandDenied, InvalidArgumentError, RemoteDenied
from mavstack.services import Address
from mavstack.services.command import Command, CommandOperation
from mavstack.services.gimbal import (
    GimbalControlChanged,
    GimbalManagerServer,
    GimbalMotion,
    GimbalSet,
    GimbalSetpoint,
    GimbalSticks,
    ListGimbals,
    PointGimbal,
    RegionOfInterest,
    SystemOfInterest,
    TakeControl,
    assign_control,
    release_control,
)
from tests.services.gimbal.harness import MANAGER, GimbalHarness
from tests.services.network import GROUND

CMD, FLAGS = common.MavCmd, common.GimbalDeviceFlags


def in_control(*device_ids: int) -> GimbalHarness:
    harness = GimbalHarness(*device_ids)
    harness.run(TakeControl(GROUND)).result()
    return harness


def point(
    harness: GimbalHarness, setpoint: GimbalSetpoint, device_id: int = 0, *, wait: bool = True
) -> PointGimbal:
    return harness.run(
        PointGimbal(setpoint, device_id, lambda: harness.monitor.attitude(device_id), wait=wait)
    )


def roi(latitude: float, longitude: float, altitude: float, device_id: int = 0) -> CommandOperation:
    frame = common.MavFrame.GLOBAL_RELATIVE_ALT
    return CommandOperation(
        Command(
            CMD.DO_SET_ROI_LOCATION,
            device_id,
            param5=latitude,
            param6=longitude,
            param7=altitude,
            frame=frame,
        )
    )


def test_all_gimbals_of_a_manager_are_listed() -> None:
    harness = GimbalHarness(1, 2, 154)
    found = harness.run(ListGimbals()).result()
    assert [each.device_id for each in found] == [1, 2, 154]
    assert found[0].pitch_range == pytest.approx((-90, 30))
    assert harness.monitor.informations[1].device_id == 2


def test_a_component_without_gimbals_has_none() -> None:
    harness = GimbalHarness()
    harness.manager.setup = None
    harness.manager.restart()
    from mavstack.services.command import CommandServer

    harness.manager.engine.add(CommandServer(MANAGER))
    assert harness.run(ListGimbals()).result() == ()


def test_setpoints_need_control() -> None:
    harness = GimbalHarness()
    denied = point(harness, GimbalSetpoint(pitch=-30, yaw=20))
    assert isinstance(denied.error, CommandDenied)
    harness.run(TakeControl(GROUND)).result()
    attitude = point(harness, GimbalSetpoint(pitch=-30, yaw=20)).result()
    assert attitude is not None
    assert (attitude.pitch, attitude.yaw) == pytest.approx((-30, 20), abs=2)
    assert harness.monitor.status().primary == GROUND
    harness.run(CommandOperation(release_control())).result()
    harness.let_pass(0.5)
    assert harness.monitor.status().primary is None
    assert isinstance(point(harness, GimbalSetpoint(pitch=0)).error, CommandDenied)


def test_control_of_another_component_is_taken_by_force_only() -> None:
    harness = GimbalHarness()
    pilot = Address(1, 191)
    harness.run(CommandOperation(assign_control(pilot, None))).result()
    refused = harness.run(TakeControl(GROUND))
    assert isinstance(refused.error, RemoteDenied)
    assert "1/191 is in control" in str(refused.error)
    harness.run(TakeControl(GROUND, secondary=True)).result()
    status = harness.server.status(1)
    assert (status.primary, status.secondary) == (pilot, GROUND)
    harness.run(TakeControl(GROUND, force=True)).result()
    assert harness.server.status(1).primary == GROUND
    assert len(harness.manager.events_of(GimbalControlChanged)) == 3


def test_placeholders_of_a_mission() -> None:
    harness = GimbalHarness()
    sender = Command(CMD.DO_GIMBAL_MANAGER_CONFIGURE, -2, -2, -1, -1)
    harness.run(CommandOperation(sender)).result()
    assert harness.server.status(1).primary == GROUND
    invalid = Command(CMD.DO_GIMBAL_MANAGER_CONFIGURE, 300, 1, -1, -1)
    assert isinstance(harness.run(CommandOperation(invalid)).error, CommandDenied)


def test_messages_of_others_are_ignored() -> None:
    harness = GimbalHarness()
    harness.send(GimbalSetpoint(pitch=-40).to_message(MANAGER, 0))
    harness.let_pass(2)
    assert harness.monitor.attitude().pitch == pytest.approx(0)
    harness.run(TakeControl(GROUND)).result()
    harness.send(GimbalSetpoint(pitch=-40, roll=10).to_message(MANAGER, 0))
    harness.let_pass(2)
    attitude = harness.monitor.attitude()
    assert (attitude.roll, attitude.pitch) == pytest.approx((10, -40), abs=0.1)


def test_a_rate_turns_until_the_limit() -> None:
    harness = in_control()
    point(harness, GimbalSetpoint(pitch_rate=-20.0, yaw_rate=0.0), wait=False).result()
    harness.let_pass(1.0)
    assert harness.monitor.attitude().pitch == pytest.approx(-20, abs=4)
    harness.let_pass(10.0)
    assert harness.monitor.attitude().pitch == pytest.approx(-90)


def test_sticks_are_scaled() -> None:
    harness = in_control()
    harness.send(GimbalSticks(pitch=-0.5, yaw_rate=1.0).to_message(MANAGER, 0))
    harness.let_pass(1.0)
    attitude = harness.monitor.attitude()
    assert attitude.pitch == pytest.approx(-45, abs=1)
    assert attitude.yaw == pytest.approx(30, abs=4)


def test_an_angle_beyond_the_range_is_not_reached() -> None:
    harness = in_control()
    stuck = point(harness, GimbalSetpoint(pitch=80))
    assert isinstance(stuck.error, ActionTimeout)
    assert "no progress for 5 s, 50 degrees to go" in str(stuck.error)
    assert harness.monitor.attitude().failures == common.GimbalDeviceErrorFlags.AT_PITCH_LIMIT


def test_retract_and_neutral() -> None:
    harness = in_control()
    point(harness, GimbalSetpoint(pitch=-60, yaw=50)).result()
    attitude = point(harness, GimbalSetpoint(neutral=True)).result()
    assert (attitude.pitch, attitude.yaw) == pytest.approx((0, 0), abs=0.1)
    assert attitude.flags & FLAGS.NEUTRAL
    assert point(harness, GimbalSetpoint(retract=True)).result().flags & FLAGS.RETRACT


def test_a_locked_yaw_keeps_its_direction_when_the_vehicle_turns() -> None:
    harness = in_control()
    harness.fly(heading=10)
    attitude = point(harness, GimbalSetpoint(yaw=90, yaw_lock=True)).result()
    assert attitude.heading == pytest.approx(90, abs=2)
    assert attitude.yaw_locked
    harness.let_pass(1)
    for heading in range(10, 100, 10):
        harness.fly(heading)
        harness.let_pass(0.2)
    attitude = harness.monitor.attitude()
    assert (attitude.yaw, attitude.heading) == pytest.approx((0, 90), abs=1)


def test_yaw_follows_the_vehicle_without_lock() -> None:
    harness = in_control()
    harness.fly(heading=10)
    point(harness, GimbalSetpoint(yaw=30)).result()
    harness.fly(heading=100)
    harness.let_pass(1)
    attitude = harness.monitor.attitude()
    assert (attitude.yaw, attitude.heading) == pytest.approx((30, 130), abs=2)


def test_one_of_several_gimbals_is_addressed() -> None:
    harness = in_control(1, 2)
    harness.run(ListGimbals()).result()
    point(harness, GimbalSetpoint(pitch=-30), 2).result()
    harness.let_pass(0.2)
    assert harness.monitor.attitude(1).pitch == pytest.approx(0)
    assert harness.monitor.attitude(2).pitch == pytest.approx(-30, abs=0.1)
    assert isinstance(point(harness, GimbalSetpoint(pitch=-30), 3).error, CommandDenied)


def test_a_region_of_interest_stays_in_view() -> None:
    harness = in_control()
    harness.fly(heading=0, height=100)
    harness.run(roi(47.0009, 8.0, 0.0)).result()  # 100 m north, 100 m below
    harness.let_pass(4)
    attitude = harness.monitor.attitude()
    assert (attitude.pitch, attitude.heading) == pytest.approx((-45, 0), abs=1)
    harness.fly(heading=45, latitude=47.0018, height=200)  # now south of the vehicle
    harness.let_pass(6)
    attitude = harness.monitor.attitude()
    assert attitude.pitch == pytest.approx(-63.4, abs=1)
    assert abs(attitude.heading) == pytest.approx(180, abs=1)
    harness.run(CommandOperation(Command(CMD.DO_SET_ROI_NONE))).result()
    harness.let_pass(5)
    assert harness.monitor.attitude().pitch == pytest.approx(0, abs=0.1)
    values = [event.value for event in harness.manager.events_of(GimbalSet)]
    assert isinstance(values[0], RegionOfInterest)
    assert values[-1] is None


def test_another_system_stays_in_view() -> None:
    harness = in_control()
    harness.fly(heading=0, height=100)
    harness.run(CommandOperation(Command(CMD.DO_SET_ROI_SYSID, GROUND.system))).result()
    position = common.GlobalPositionInt(lat=470000000, lon=80013200, alt=400_000)
    harness.send(position)
    harness.let_pass(4)
    attitude = harness.monitor.attitude()
    assert (attitude.pitch, attitude.heading) == pytest.approx((-45, 90), abs=1)
    assert harness.manager.events_of(GimbalSet)[0].value == SystemOfInterest(GROUND.system)
    own = Command(CMD.DO_SET_ROI_SYSID, MANAGER.system)
    assert isinstance(harness.run(CommandOperation(own)).error, CommandDenied)


@pytest.mark.parametrize("place", [(91.0, 8.0, 0.0), (47.0, 8.0, float("nan")), (float("inf"), 8.0, 0.0)])
def test_a_location_off_the_earth_is_refused(place: tuple[float, float, float]) -> None:
    harness = in_control()
    latitude, longitude, altitude = place
    command = Command(CMD.DO_SET_ROI_LOCATION, param5=latitude, param6=longitude, param7=altitude)
    assert isinstance(harness.run(CommandOperation(command)).error, CommandDenied)


@pytest.mark.parametrize("ids", [(), (1, 1), (0,)])
def test_device_ids_must_differ(ids: tuple[int, ...]) -> None:
    from mavstack.services.gimbal import GimbalInformation

    with pytest.raises(InvalidArgumentError, match="different device ids"):
        GimbalManagerServer(MANAGER, [GimbalMotion(GimbalInformation(number)) for number in ids])


def test_pointing_a_gimbal_that_does_not_report_fails() -> None:
    harness = in_control(154)  # a device of its own, which is not on the network
    silent = point(harness, GimbalSetpoint(pitch=-10))
    assert "does not report its attitude" in str(silent.error)
    assert point(harness, GimbalSetpoint(pitch=-10), wait=False).result() is None


def test_an_unset_device_id_stands_for_all() -> None:
    harness = GimbalHarness(1, 2)
    nan = float("nan")
    command = Command(CMD.DO_GIMBAL_MANAGER_CONFIGURE, -2, -2, -1, -1, nan, nan, nan)
    harness.run(CommandOperation(command)).result()
    assert harness.server.status(1).primary == harness.server.status(2).primary == GROUND
    request = Command(CMD.REQUEST_MESSAGE, 280, nan, nan, nan, nan, nan, nan)
    harness.run(CommandOperation(request)).result()
    harness.let_pass(0.1)
    assert len(harness.monitor.informations) == 2
