"""The commands that a `CameraServer` answers."""

from __future__ import annotations

from math import isfinite, isnan
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, InvalidTypeError
from mavstack.services.camera import commands as requests
from mavstack.services.camera.media import TrackedTarget

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.services.camera.managed import ManagedCamera
    from mavstack.services.camera.server import CameraServer
    from mavstack.services.command import CommandRequest, CommandServer

    Do: TypeAlias = "Callable[[ManagedCamera, CommandRequest], common.MavResult]"

_CMD, _RESULT, _CAPS = common.MavCmd, common.MavResult, common.CameraCapFlags
_MODES = frozenset(int(mode) for mode in common.CameraMode)
MAX_STATUS_RATE = 50.0
MAX_ID = 255


class CameraCommands:
    """The handlers of the camera commands; each selects its cameras and checks their abilities."""

    def __init__(self, cameras: CameraServer) -> None:
        self._cameras = cameras

    def register(self, commands: CommandServer) -> None:
        """Register the handlers."""

        def support(command: int, index: int, needs: int, do: Do) -> None:
            commands.support(command, lambda request: self._each(request, index, needs, do))

        support(_CMD.IMAGE_START_CAPTURE, 1, _CAPS.CAPTURE_IMAGE, self._start_images)
        support(_CMD.IMAGE_STOP_CAPTURE, 1, _CAPS.CAPTURE_IMAGE, self._stop_images)
        support(_CMD.VIDEO_START_CAPTURE, 3, _CAPS.CAPTURE_VIDEO, self._start_video)
        support(_CMD.VIDEO_STOP_CAPTURE, 2, _CAPS.CAPTURE_VIDEO, self._stop_video)
        support(_CMD.VIDEO_START_STREAMING, 2, _CAPS.HAS_VIDEO_STREAM, self._start_streaming)
        support(_CMD.VIDEO_STOP_STREAMING, 2, _CAPS.HAS_VIDEO_STREAM, self._stop_streaming)
        support(_CMD.SET_CAMERA_MODE, 1, _CAPS.HAS_MODES, self._set_mode)
        support(_CMD.SET_CAMERA_ZOOM, 3, _CAPS.HAS_BASIC_ZOOM, self._zoom)
        support(_CMD.SET_CAMERA_FOCUS, 3, _CAPS.HAS_BASIC_FOCUS, self._focus)
        support(_CMD.RESET_CAMERA_SETTINGS, 2, 0, self._reset)
        support(_CMD.CAMERA_TRACK_POINT, 4, _CAPS.HAS_TRACKING_POINT, self._track_point)
        support(_CMD.CAMERA_TRACK_RECTANGLE, 5, _CAPS.HAS_TRACKING_RECTANGLE, self._track_rectangle)
        support(_CMD.CAMERA_STOP_TRACKING, 1, 0, self._stop_tracking)
        commands.support(_CMD.STORAGE_FORMAT, self._format)

    def _each(self, request: CommandRequest, index: int, needs: int, do: Do) -> tuple[common.MavResult, int]:
        """Execute a command on the cameras of the device id in a parameter.

        The id is also the detail of the acknowledgement (guide: camera addressing in commands).
        """
        wanted = _parameter(request, index)
        device_id = 0 if isnan(wanted) else int(wanted) if 0 <= wanted <= MAX_ID else -1
        selected = self._cameras.selected(device_id)
        able = [camera for camera in selected if camera.device.information.can(needs)]
        if not able:
            return (_RESULT.UNSUPPORTED if selected else _RESULT.DENIED), max(device_id, 0)
        results = [do(camera, request) for camera in able]
        return _worst(results), device_id

    # Images and video

    def _start_images(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        command, now = request.command, request.received_at
        interval, count = command.param2, command.param3
        if not (isfinite(count) and count >= 0 and count == int(count)):
            return _RESULT.DENIED
        if count != 1 and not (isfinite(interval) and interval > 0):
            return _RESULT.DENIED
        if not camera.sequence.may_capture or camera.sequence.next_due is not None:
            return _RESULT.TEMPORARILY_REJECTED
        sequence = command.param4 if count == 1 and isfinite(command.param4) else 0.0
        if camera.repeats(request.source, sequence, now):
            return _RESULT.ACCEPTED
        camera.sequence.start(interval, int(count), now)
        self._cameras.report_capture(camera, now)
        return _RESULT.ACCEPTED

    def _stop_images(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        camera.sequence.stop()
        self._cameras.report_capture(camera, request.received_at)
        return _RESULT.ACCEPTED

    def _start_video(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        stream, rate, now = request.command.param1, request.command.param2, request.received_at
        if not camera.has_stream(stream) and stream != 0:
            return _RESULT.DENIED
        if not camera.sequence.may_record or camera.sequence.recording_since is not None:
            return _RESULT.TEMPORARILY_REJECTED
        if not camera.device.start_video(int(stream), now):
            return _RESULT.FAILED
        camera.sequence.recording_since = now
        camera.stream_status(min(rate, MAX_STATUS_RATE) if isfinite(rate) else 0.0, now)
        self._cameras.report_capture(camera, now)
        return _RESULT.ACCEPTED

    def _stop_video(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        now = request.received_at
        if camera.sequence.recording_since is None:
            return _RESULT.ACCEPTED
        stream = request.command.param1
        if not camera.device.stop_video(int(stream) if camera.has_stream(stream) else 0, now):
            return _RESULT.FAILED
        camera.sequence.recording_since = None
        camera.stream_status(0.0, now)
        self._cameras.report_capture(camera, now)
        return _RESULT.ACCEPTED

    def _start_streaming(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        return self._streaming(camera, request, running=True)

    def _stop_streaming(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        return self._streaming(camera, request, running=False)

    def _streaming(
        self, camera: ManagedCamera, request: CommandRequest, *, running: bool
    ) -> common.MavResult:
        stream = request.command.param1
        if not camera.has_stream(stream):
            return _RESULT.DENIED
        if not camera.device.set_streaming(int(stream), running, request.received_at):
            return _RESULT.FAILED
        camera.set_running(int(stream), running)
        return _RESULT.ACCEPTED

    # Settings

    def _set_mode(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        mode, now = request.command.param2, request.received_at
        if mode not in _MODES or (
            mode == common.CameraMode.IMAGE_SURVEY
            and not camera.device.information.can(_CAPS.HAS_IMAGE_SURVEY_MODE)
        ):
            return _RESULT.DENIED
        if camera.sequence.recording_since is not None or camera.sequence.next_due is not None:
            return _RESULT.TEMPORARILY_REJECTED
        if not camera.device.set_mode(int(mode), now):
            return _RESULT.FAILED
        self._cameras.enter_mode(camera, int(mode), now)
        return _RESULT.ACCEPTED

    def _zoom(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        return self._adjust(camera, request, requests.set_zoom, camera.device.set_zoom)

    def _focus(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        return self._adjust(camera, request, requests.set_focus, camera.device.set_focus)

    def _adjust(
        self,
        camera: ManagedCamera,
        request: CommandRequest,
        check: Callable[[int, float, int], object],
        adjust: Callable[[int, float, float], bool],
    ) -> common.MavResult:
        kind, value = request.command.param1, request.command.param2
        if not (isfinite(kind) and kind == int(kind)):
            return _RESULT.DENIED
        try:
            check(0, value, int(kind))
        except (InvalidArgumentError, InvalidTypeError):
            return _RESULT.DENIED
        if not adjust(int(kind), value, request.received_at):
            return _RESULT.DENIED
        self._cameras.report_settings(camera, request.received_at)
        return _RESULT.ACCEPTED

    def _reset(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        if request.command.param1 != 1:
            return _RESULT.DENIED
        if not camera.device.reset_settings(request.received_at):
            return _RESULT.UNSUPPORTED
        self._cameras.report_settings(camera, request.received_at)
        return _RESULT.ACCEPTED

    def _format(self, request: CommandRequest) -> common.MavResult:
        """STORAGE_FORMAT: erase a storage, or reset the image log alone."""
        storage, erase, reset = request.command.param1, request.command.param2, request.command.param3
        now, done = request.received_at, False
        for camera in self._cameras.selected(0.0):
            known = {each.id for each in camera.device.storages}
            if erase == 1 and (storage in known or (storage == 0 and known)):
                if not camera.device.format_storage(int(storage), now):
                    return _RESULT.FAILED
                done = True
                self._cameras.report_storages(camera, now)
            if reset == 1 or (erase == 1 and done):
                camera.sequence.reset_log()
                self._cameras.report_capture(camera, now)
                done = True
        return _RESULT.ACCEPTED if done else _RESULT.DENIED

    # Tracking

    def _track_point(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        command = request.command
        x, y, radius = command.param1, command.param2, command.param3
        if not _are_shares((x, y, radius if isfinite(radius) else 0.0)):
            return _RESULT.DENIED
        target = TrackedTarget(
            common.CameraTrackingStatusFlags.ACTIVE, (x, y), radius, device_id=camera.device_id
        )
        return self._track(camera, target, request)

    def _track_rectangle(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        command = request.command
        left, top, right, bottom = command.param1, command.param2, command.param3, command.param4
        if not _are_shares((left, top, right, bottom)) or left >= right or top >= bottom:
            return _RESULT.DENIED
        target = TrackedTarget(
            common.CameraTrackingStatusFlags.ACTIVE,
            rectangle=(left, top, right, bottom),
            device_id=camera.device_id,
        )
        return self._track(camera, target, request)

    def _stop_tracking(self, camera: ManagedCamera, request: CommandRequest) -> common.MavResult:
        if not camera.can_track:
            return _RESULT.UNSUPPORTED
        return self._track(camera, None, request)

    def _track(
        self, camera: ManagedCamera, target: TrackedTarget | None, request: CommandRequest
    ) -> common.MavResult:
        done = camera.device.track(target, request.received_at)
        return _RESULT.ACCEPTED if done else _RESULT.FAILED


def _parameter(request: CommandRequest, index: int) -> float:
    value: float = getattr(request.command, f"param{index}")
    return value


def _are_shares(values: Sequence[float]) -> bool:
    return all(0.0 <= value <= 1.0 for value in values)


def _worst(results: list[common.MavResult]) -> common.MavResult:
    """Return the first result that is not ACCEPTED."""
    return next((result for result in results if result != _RESULT.ACCEPTED), _RESULT.ACCEPTED)
