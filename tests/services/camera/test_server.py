"""The camera protocol over a network: both ends."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, InvalidArgumentError, MessageTimeout, ModeTimeout, RemoteDenied
from mavstack.services.camera import (
    CameraInformation,
    CameraModeEntered,
    CameraServer,
    CaptureStatus,
    ImageTaken,
    ListCameras,
    ListStorages,
    ListStreams,
    RequestReport,
    SetCameraMode,
    TakePhoto,
    commands,
)
from mavstack.services.command import Command, CommandOperation, CommandServer
from tests.services.camera.harness import CAMERA, CAPS, EVERYTHING, Camera, CameraHarness
from tests.services.network import GROUND

CMD, RESULT, MODE = common.MavCmd, common.MavResult, common.CameraMode


def do(harness: CameraHarness, command: Command) -> CommandOperation:
    return harness.run(CommandOperation(command))


def result_of(operation: CommandOperation) -> int:
    if operation.error is None:
        return RESULT.ACCEPTED
    assert isinstance(operation.error, CommandDenied)
    return operation.error.code


def capture_status(harness: CameraHarness, device_id: int = 0) -> CaptureStatus:
    report = harness.run(RequestReport(common.CameraCaptureStatus, device_id)).result()
    return CaptureStatus.read(report)


def test_a_camera_is_identified() -> None:
    harness = CameraHarness()
    (found,) = harness.run(ListCameras()).result()
    assert (found.vendor, found.model, found.capabilities) == ("Maker", "Model", EVERYTHING)
    assert harness.monitor.reports().information == found
    assert harness.monitor.device_ids == (0,)


def test_cameras_attached_to_the_autopilot() -> None:
    harness = CameraHarness(1, 3)
    found = harness.run(ListCameras()).result()
    assert [each.device_id for each in found] == [1, 3]
    image = harness.run(TakePhoto(3, 1)).result()
    assert image.device_id == 3
    assert (harness.devices[0].images, harness.devices[1].images) == ([], [0])
    do(harness, commands.start_images(0)).result()  # all of them
    assert (harness.devices[0].images, harness.devices[1].images) == ([0], [0, 1])
    assert result_of(do(harness, commands.start_images(2))) == RESULT.DENIED
    assert do(harness, commands.start_images(3)).result().detail == 3


def test_an_autopilot_without_cameras() -> None:
    harness = CameraHarness()
    harness.camera.setup = lambda engine: engine.add(CommandServer(CAMERA))
    harness.camera.restart()
    assert harness.run(ListCameras()).result() == ()


def test_a_photo_is_taken_and_reported() -> None:
    harness = CameraHarness()
    image = harness.run(TakePhoto(0, 1)).result()
    assert (image.index, image.success) == (0, True)
    assert image.time == pytest.approx(harness.network.now, abs=5)
    assert harness.run(TakePhoto(0, 2)).result().index == 1
    assert harness.reported == [0, 1]
    assert capture_status(harness).image_count == 2
    assert len(harness.camera.events_of(ImageTaken)) == 2


def test_a_failed_photo_is_an_error() -> None:
    harness = CameraHarness()
    harness.device.works = False
    photo = harness.run(TakePhoto(0, 1))
    assert isinstance(photo.error, RemoteDenied)
    assert "the capture failed" in str(photo.error)


def test_a_camera_that_never_reports_the_image() -> None:
    harness = CameraHarness()
    harness.device.capture = lambda index, now: None
    photo = harness.run(TakePhoto(0, 1))
    assert isinstance(photo.error, MessageTimeout)
    assert "accepted, but the camera reported no image" in str(photo.error)
    assert capture_status(harness).capturing


def test_an_image_that_takes_time() -> None:
    harness = CameraHarness()
    harness.device.capture = lambda index, now: None

    def develop() -> None:
        harness.server.image_captured(Camera.capture(harness.device, 0, 5.0), harness.network.now)
        harness.camera.engine.touch(harness.server)

    harness.network.at(7.0, develop)
    assert harness.run(TakePhoto(0, 1)).result().time == 5.0
    assert not capture_status(harness).capturing


def test_a_repeated_request_takes_one_photo() -> None:
    harness = CameraHarness()
    command = commands.start_images(0, sequence=7)
    do(harness, command).result()
    harness.let_pass(1)  # not a copy of the packet, but another request with the same number
    do(harness, command).result()
    assert harness.device.images == [0]
    harness.let_pass(10)  # a program that was started again counts from 1 too
    do(harness, command).result()
    assert harness.device.images == [0, 1]


def test_a_series_of_images() -> None:
    harness = CameraHarness()
    do(harness, commands.start_images(0, interval=2.0, count=4)).result()
    assert capture_status(harness).interval == 2.0
    assert result_of(do(harness, commands.start_images(0))) == RESULT.TEMPORARILY_REJECTED
    harness.let_pass(5)
    assert harness.device.images == [0, 1, 2]
    harness.let_pass(20)
    assert harness.device.images == [0, 1, 2, 3]
    assert capture_status(harness).interval is None
    do(harness, commands.start_images(0, interval=1.0, count=0)).result()
    harness.let_pass(10)
    do(harness, commands.stop_images(0)).result()
    taken = len(harness.device.images)
    assert taken == pytest.approx(14, abs=1)
    harness.let_pass(10)
    assert len(harness.device.images) == taken
    assert harness.reported == list(range(taken))


def test_lost_images_are_requested_again() -> None:
    harness = CameraHarness()
    harness.press_button()
    _, back = harness.pipes
    back.cut = True
    harness.press_button(3)
    back.cut = False
    harness.press_button()
    harness.let_pass(5)
    assert sorted(harness.reported) == [0, 1, 2, 3, 4]
    assert len(harness.reported) == 5


def test_the_last_image_is_found_by_the_count() -> None:
    harness = CameraHarness()
    harness.press_button()
    harness.pipes[1].cut = True
    harness.press_button(2)
    harness.pipes[1].cut = False
    capture_status(harness)
    harness.let_pass(5)
    assert sorted(harness.reported) == [0, 1, 2]


def test_images_from_before_are_not_requested() -> None:
    harness = CameraHarness()
    harness.pipes[1].cut = True
    harness.press_button(3)
    harness.pipes[1].cut = False
    harness.press_button()
    harness.let_pass(5)
    assert harness.reported == [3]


def test_after_a_format_the_images_count_from_zero() -> None:
    harness = CameraHarness()
    harness.run(TakePhoto(0, 1)).result()
    harness.let_pass(1)
    do(harness, commands.format_storage(1)).result()
    assert harness.device.used == 0.0
    assert harness.monitor.storages[1].used == 0.0
    assert capture_status(harness).image_count == 0
    harness.let_pass(1)
    assert harness.run(TakePhoto(0, 2)).result().index == 0
    assert harness.reported == [0, 0]
    assert result_of(do(harness, commands.format_storage(4))) == RESULT.DENIED
    reset = commands.format_storage(1, erase=False, reset_image_log=True)
    do(harness, reset).result()
    assert capture_status(harness).image_count == 0


def test_video() -> None:
    harness = CameraHarness(capabilities=EVERYTHING & ~int(CAPS.HAS_MODES))
    do(harness, commands.start_video(0, status_rate=2.0)).result()
    harness.let_pass(3)
    status = harness.monitor.reports().capture
    assert status.recording
    assert status.recording_time == pytest.approx(3, abs=0.7)
    assert result_of(do(harness, commands.start_video(0))) == RESULT.TEMPORARILY_REJECTED
    do(harness, commands.stop_video(0)).result()
    do(harness, commands.stop_video(0)).result()
    assert not capture_status(harness).recording
    harness.device.works = False
    assert result_of(do(harness, commands.start_video(0))) == RESULT.FAILED


def test_modes_decide_what_can_be_captured() -> None:
    harness = CameraHarness()
    assert result_of(do(harness, commands.start_video(0))) == RESULT.TEMPORARILY_REJECTED
    assert harness.run(SetCameraMode(0, MODE.VIDEO)).result() == MODE.VIDEO
    assert harness.monitor.reports().status.mode == MODE.VIDEO
    assert harness.camera.events_of(CameraModeEntered) == [CameraModeEntered(MODE.VIDEO, 0)]
    assert result_of(do(harness, commands.start_images(0))) == RESULT.TEMPORARILY_REJECTED
    do(harness, commands.start_video(0)).result()
    changed = harness.run(SetCameraMode(0, MODE.IMAGE))
    assert changed.error.code == RESULT.TEMPORARILY_REJECTED
    survey = harness.run(SetCameraMode(0, MODE.IMAGE_SURVEY))
    assert "setting mode image_survey of 1/100 failed" in str(survey.error) or survey.error.code == 2


def test_a_mode_that_the_camera_accepts_and_does_not_enter() -> None:
    harness = CameraHarness()
    harness.server.enter_mode = lambda camera, mode, now: None
    error = harness.run(SetCameraMode(0, MODE.VIDEO)).error
    assert isinstance(error, ModeTimeout)
    assert str(error).endswith("accepted, but the camera reports mode image")
    assert harness.run(SetCameraMode(0, MODE.VIDEO, confirm=False)).result() == MODE.VIDEO


def test_both_modes_at_the_same_time() -> None:
    harness = CameraHarness(capabilities=EVERYTHING | int(CAPS.CAN_CAPTURE_VIDEO_IN_IMAGE_MODE))
    do(harness, commands.start_video(0)).result()
    harness.run(TakePhoto(0, 1)).result()


def test_storages_and_streams_are_listed() -> None:
    harness = CameraHarness()
    (storage,) = harness.run(ListStorages()).result()
    assert (storage.id, storage.available, storage.name) == (1, 900.0, "card")
    streams = harness.run(ListStreams(0)).result()
    assert [(each.id, each.uri, each.running) for each in streams] == [
        (1, "rtsp://camera/1", True),
        (2, "rtsp://camera/2", False),
    ]
    do(harness, commands.start_streaming(0, 2)).result()
    do(harness, commands.stop_streaming(0, 1)).result()
    assert [each.running for each in harness.run(ListStreams(0)).result()] == [False, True]
    assert result_of(do(harness, commands.start_streaming(0, 9))) == RESULT.DENIED
    assert harness.device.calls == [("streaming", 2, True), ("streaming", 1, False)]


def test_a_lost_stream_is_requested_by_its_number() -> None:
    harness = CameraHarness()
    original = harness.server._streams
    answers = iter([1, 2])
    harness.server._streams = lambda which, now: original(which or next(answers), now)
    messages = harness.camera.engine
    harness.camera.setup = None
    server = next(each for each in messages._services if type(each).__name__ == "MessageServer")
    server.provide_instances(common.VideoStreamInformation, harness.server._streams)
    assert [each.id for each in harness.run(ListStreams(0)).result()] == [1, 2]


def test_zoom_and_focus() -> None:
    harness = CameraHarness()
    do(harness, commands.set_zoom(0, 40.0)).result()
    do(harness, commands.set_focus(0, 70.0)).result()
    status = harness.monitor.reports().status
    assert (status.zoom, status.focus) == (40.0, 70.0)
    do(harness, commands.reset_settings(0)).result()
    harness.let_pass(0.1)
    assert harness.monitor.reports().status.zoom is None
    beyond = replace(commands.set_zoom(0, 40.0), param2=140.0)
    assert result_of(do(harness, beyond)) == RESULT.DENIED
    do(harness, commands.set_focus(0, 0.0, common.SetFocusType.AUTO)).result()


def test_tracking() -> None:
    harness = CameraHarness()
    do(harness, commands.track_point(0, 0.25, 0.75, 0.1)).result()
    harness.let_pass(1)
    tracked = harness.monitor.reports().tracked
    assert tracked.active
    assert tracked.point == (0.25, 0.75)
    assert tracked.radius == pytest.approx(0.1)
    do(harness, commands.track_rectangle(0, 0.25, 0.25, 0.5, 0.75)).result()
    harness.let_pass(1)
    assert harness.monitor.reports().tracked.rectangle == (0.25, 0.25, 0.5, 0.75)
    do(harness, commands.stop_tracking(0)).result()
    assert harness.device.target is None
    outside = replace(commands.track_point(0, 0.5, 0.5), param1=1.5)
    assert result_of(do(harness, outside)) == RESULT.DENIED


@pytest.mark.parametrize(
    "command",
    [
        commands.start_images(0),
        commands.start_video(0),
        commands.start_streaming(0, 1),
        commands.set_mode(0, 1),
        commands.set_zoom(0, 1),
        commands.set_focus(0, 1),
        commands.track_point(0, 0.5, 0.5),
        commands.stop_tracking(0),
    ],
)
def test_abilities_that_the_camera_lacks_are_unsupported(command: Command) -> None:
    assert result_of(do(CameraHarness(capabilities=0), command)) == RESULT.UNSUPPORTED


def test_a_camera_component_answers_to_its_component_id() -> None:
    harness = CameraHarness()
    do(harness, commands.start_images(CAMERA.component)).result()
    assert result_of(do(harness, commands.start_images(101))) == RESULT.DENIED


@pytest.mark.parametrize("ids", [(), (1, 1), (7,), (0, 1)])
def test_device_ids(ids: tuple[int, ...]) -> None:
    with pytest.raises(InvalidArgumentError, match="different device ids"):
        CameraServer(GROUND, [Camera(CameraInformation(device_id=number)) for number in ids])


@pytest.mark.parametrize(
    "make",
    [
        lambda: commands.start_images(0, interval=0.0, count=2),
        lambda: commands.start_images(0, interval=-1.0),
        lambda: commands.set_zoom(0, 101.0),
        lambda: commands.set_focus(0, -1.0),
        lambda: commands.start_video(0, status_rate=-1.0),
        lambda: commands.track_point(0, 0.5, 1.5),
        lambda: commands.track_rectangle(0, 0.5, 0.5, 0.25, 0.75),
    ],
)
def test_senseless_arguments_are_refused_before_anything_is_sent(make) -> None:
    with pytest.raises(InvalidArgumentError):
        make()
