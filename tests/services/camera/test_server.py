"""The camera protocol over a network: both ends."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, InvalidArgumentError, MessageTimeout, RemoteDenied
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
from tests.services.camera.pairs import CAMERA, CAPS, EVERYTHING, Camera, Pair
from tests.services.network import GROUND

CMD, RESULT, MODE = common.MavCmd, common.MavResult, common.CameraMode


def do(pair: Pair, command: Command) -> CommandOperation:
    return pair.run(CommandOperation(command))


def result_of(operation: CommandOperation) -> int:
    if operation.error is None:
        return RESULT.ACCEPTED
    assert isinstance(operation.error, CommandDenied)
    return operation.error.code


def capture_status(pair: Pair, device_id: int = 0) -> CaptureStatus:
    report = pair.run(RequestReport(common.CameraCaptureStatus, device_id)).result()
    return CaptureStatus.read(report)


def test_a_camera_is_identified() -> None:
    pair = Pair()
    (found,) = pair.run(ListCameras()).result()
    assert (found.vendor, found.model, found.capabilities) == ("Maker", "Model", EVERYTHING)
    assert pair.monitor.reports().information == found
    assert pair.monitor.device_ids == (0,)


def test_cameras_attached_to_the_autopilot() -> None:
    pair = Pair(1, 3)
    found = pair.run(ListCameras()).result()
    assert [each.device_id for each in found] == [1, 3]
    image = pair.run(TakePhoto(3, 1)).result()
    assert image.device_id == 3
    assert (pair.devices[0].images, pair.devices[1].images) == ([], [0])
    do(pair, commands.start_images(0)).result()  # all of them
    assert (pair.devices[0].images, pair.devices[1].images) == ([0], [0, 1])
    assert result_of(do(pair, commands.start_images(2))) == RESULT.DENIED
    assert do(pair, commands.start_images(3)).result().detail == 3


def test_an_autopilot_without_cameras() -> None:
    pair = Pair()
    pair.camera.setup = lambda engine: engine.add(CommandServer(CAMERA))
    pair.camera.restart()
    assert pair.run(ListCameras()).result() == ()


def test_a_photo_is_taken_and_reported() -> None:
    pair = Pair()
    image = pair.run(TakePhoto(0, 1)).result()
    assert (image.index, image.success) == (0, True)
    assert image.time == pytest.approx(pair.network.now, abs=5)
    assert pair.run(TakePhoto(0, 2)).result().index == 1
    assert pair.reported == [0, 1]
    assert capture_status(pair).image_count == 2
    assert len(pair.camera.events_of(ImageTaken)) == 2


def test_a_failed_photo_is_an_error() -> None:
    pair = Pair()
    pair.device.works = False
    photo = pair.run(TakePhoto(0, 1))
    assert isinstance(photo.error, RemoteDenied)
    assert "the capture failed" in str(photo.error)


def test_a_camera_that_never_reports_the_image() -> None:
    pair = Pair()
    pair.device.capture = lambda index, now: None
    photo = pair.run(TakePhoto(0, 1))
    assert isinstance(photo.error, MessageTimeout)
    assert "accepted, but the camera reported no image" in str(photo.error)
    assert capture_status(pair).capturing


def test_an_image_that_takes_time() -> None:
    pair = Pair()
    pair.device.capture = lambda index, now: None

    def develop() -> None:
        pair.server.image_captured(Camera.capture(pair.device, 0, 5.0), pair.network.now)
        pair.camera.engine.touch(pair.server)

    pair.network.at(7.0, develop)
    assert pair.run(TakePhoto(0, 1)).result().time == 5.0
    assert not capture_status(pair).capturing


def test_a_repeated_request_takes_one_photo() -> None:
    pair = Pair()
    command = commands.start_images(0, sequence=7)
    do(pair, command).result()
    pair.let_pass(1)  # not a copy of the packet, but another request with the same number
    do(pair, command).result()
    assert pair.device.images == [0]
    pair.let_pass(10)  # a program that was started again counts from 1 too
    do(pair, command).result()
    assert pair.device.images == [0, 1]


def test_a_series_of_images() -> None:
    pair = Pair()
    do(pair, commands.start_images(0, interval=2.0, count=4)).result()
    assert capture_status(pair).interval == 2.0
    assert result_of(do(pair, commands.start_images(0))) == RESULT.TEMPORARILY_REJECTED
    pair.let_pass(5)
    assert pair.device.images == [0, 1, 2]
    pair.let_pass(20)
    assert pair.device.images == [0, 1, 2, 3]
    assert capture_status(pair).interval is None
    do(pair, commands.start_images(0, interval=1.0, count=0)).result()
    pair.let_pass(10)
    do(pair, commands.stop_images(0)).result()
    taken = len(pair.device.images)
    assert taken == pytest.approx(14, abs=1)
    pair.let_pass(10)
    assert len(pair.device.images) == taken
    assert pair.reported == list(range(taken))


def test_lost_images_are_requested_again() -> None:
    pair = Pair()
    pair.press_button()
    _, back = pair.pipes
    back.cut = True
    pair.press_button(3)
    back.cut = False
    pair.press_button()
    pair.let_pass(5)
    assert sorted(pair.reported) == [0, 1, 2, 3, 4]
    assert len(pair.reported) == 5


def test_the_last_image_is_found_by_the_count() -> None:
    pair = Pair()
    pair.press_button()
    pair.pipes[1].cut = True
    pair.press_button(2)
    pair.pipes[1].cut = False
    capture_status(pair)
    pair.let_pass(5)
    assert sorted(pair.reported) == [0, 1, 2]


def test_images_from_before_are_not_requested() -> None:
    pair = Pair()
    pair.pipes[1].cut = True
    pair.press_button(3)
    pair.pipes[1].cut = False
    pair.press_button()
    pair.let_pass(5)
    assert pair.reported == [3]


def test_after_a_format_the_images_count_from_zero() -> None:
    pair = Pair()
    pair.run(TakePhoto(0, 1)).result()
    pair.let_pass(1)
    do(pair, commands.format_storage(1)).result()
    assert pair.device.used == 0.0
    assert pair.monitor.storages[1].used == 0.0
    assert capture_status(pair).image_count == 0
    pair.let_pass(1)
    assert pair.run(TakePhoto(0, 2)).result().index == 0
    assert pair.reported == [0, 0]
    assert result_of(do(pair, commands.format_storage(4))) == RESULT.DENIED
    reset = commands.format_storage(1, erase=False, reset_image_log=True)
    do(pair, reset).result()
    assert capture_status(pair).image_count == 0


def test_video() -> None:
    pair = Pair(capabilities=EVERYTHING & ~int(CAPS.HAS_MODES))
    do(pair, commands.start_video(0, status_rate=2.0)).result()
    pair.let_pass(3)
    status = pair.monitor.reports().capture
    assert status.recording
    assert status.recording_time == pytest.approx(3, abs=0.7)
    assert result_of(do(pair, commands.start_video(0))) == RESULT.TEMPORARILY_REJECTED
    do(pair, commands.stop_video(0)).result()
    do(pair, commands.stop_video(0)).result()
    assert not capture_status(pair).recording
    pair.device.works = False
    assert result_of(do(pair, commands.start_video(0))) == RESULT.FAILED


def test_modes_decide_what_can_be_captured() -> None:
    pair = Pair()
    assert result_of(do(pair, commands.start_video(0))) == RESULT.TEMPORARILY_REJECTED
    assert pair.run(SetCameraMode(0, MODE.VIDEO)).result() == MODE.VIDEO
    assert pair.monitor.reports().status.mode == MODE.VIDEO
    assert pair.camera.events_of(CameraModeEntered) == [CameraModeEntered(MODE.VIDEO, 0)]
    assert result_of(do(pair, commands.start_images(0))) == RESULT.TEMPORARILY_REJECTED
    do(pair, commands.start_video(0)).result()
    changed = pair.run(SetCameraMode(0, MODE.IMAGE))
    assert changed.error.code == RESULT.TEMPORARILY_REJECTED
    survey = pair.run(SetCameraMode(0, MODE.IMAGE_SURVEY))
    assert "setting mode image_survey of 1/100 failed" in str(survey.error) or survey.error.code == 2


def test_both_modes_at_the_same_time() -> None:
    pair = Pair(capabilities=EVERYTHING | int(CAPS.CAN_CAPTURE_VIDEO_IN_IMAGE_MODE))
    do(pair, commands.start_video(0)).result()
    pair.run(TakePhoto(0, 1)).result()


def test_storages_and_streams_are_listed() -> None:
    pair = Pair()
    (storage,) = pair.run(ListStorages()).result()
    assert (storage.id, storage.available, storage.name) == (1, 900.0, "card")
    streams = pair.run(ListStreams(0)).result()
    assert [(each.id, each.uri, each.running) for each in streams] == [
        (1, "rtsp://camera/1", True),
        (2, "rtsp://camera/2", False),
    ]
    do(pair, commands.start_streaming(0, 2)).result()
    do(pair, commands.stop_streaming(0, 1)).result()
    assert [each.running for each in pair.run(ListStreams(0)).result()] == [False, True]
    assert result_of(do(pair, commands.start_streaming(0, 9))) == RESULT.DENIED
    assert pair.device.calls == [("streaming", 2, True), ("streaming", 1, False)]


def test_a_lost_stream_is_requested_by_its_number() -> None:
    pair = Pair()
    original = pair.server._streams
    answers = iter([1, 2])
    pair.server._streams = lambda which, now: original(which or next(answers), now)
    messages = pair.camera.engine
    pair.camera.setup = None
    server = next(each for each in messages._services if type(each).__name__ == "MessageServer")
    server.provide_instances(common.VideoStreamInformation, pair.server._streams)
    assert [each.id for each in pair.run(ListStreams(0)).result()] == [1, 2]


def test_zoom_and_focus() -> None:
    pair = Pair()
    do(pair, commands.set_zoom(0, 40.0)).result()
    do(pair, commands.set_focus(0, 70.0)).result()
    status = pair.monitor.reports().status
    assert (status.zoom, status.focus) == (40.0, 70.0)
    do(pair, commands.reset_settings(0)).result()
    pair.let_pass(0.1)
    assert pair.monitor.reports().status.zoom is None
    beyond = replace(commands.set_zoom(0, 40.0), param2=140.0)
    assert result_of(do(pair, beyond)) == RESULT.DENIED
    do(pair, commands.set_focus(0, 0.0, common.SetFocusType.AUTO)).result()


def test_tracking() -> None:
    pair = Pair()
    do(pair, commands.track_point(0, 0.25, 0.75, 0.1)).result()
    pair.let_pass(1)
    tracked = pair.monitor.reports().tracked
    assert tracked.active
    assert tracked.point == (0.25, 0.75)
    assert tracked.radius == pytest.approx(0.1)
    do(pair, commands.track_rectangle(0, 0.25, 0.25, 0.5, 0.75)).result()
    pair.let_pass(1)
    assert pair.monitor.reports().tracked.rectangle == (0.25, 0.25, 0.5, 0.75)
    do(pair, commands.stop_tracking(0)).result()
    assert pair.device.target is None
    outside = replace(commands.track_point(0, 0.5, 0.5), param1=1.5)
    assert result_of(do(pair, outside)) == RESULT.DENIED


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
    assert result_of(do(Pair(capabilities=0), command)) == RESULT.UNSUPPORTED


def test_a_camera_component_answers_to_its_component_id() -> None:
    pair = Pair()
    do(pair, commands.start_images(CAMERA.component)).result()
    assert result_of(do(pair, commands.start_images(101))) == RESULT.DENIED


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
