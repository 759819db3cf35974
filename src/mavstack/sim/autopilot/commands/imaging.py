"""Commands of the camera and the gimbal."""

from __future__ import annotations

from math import inf, isfinite, radians
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.commands.registration import CommandGroup, Handlers, number, whole
from mavstack.sim.autopilot.payload import Gimbal

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.sim.autopilot.payload import Payload

_CMD, _RESULT = common.MavCmd, common.MavResult
_MAX_GLIDE_SLOPE = 90.0


class CameraCommands(CommandGroup):
    """Pictures, video, zoom and focus."""

    @property
    def payload(self) -> Payload:
        """The payload of the vehicle."""
        return self.autopilot.payload

    def handlers(self) -> Handlers:
        return {
            _CMD.IMAGE_START_CAPTURE: self.take_images,
            _CMD.IMAGE_STOP_CAPTURE: self.stop_images,
            _CMD.VIDEO_START_CAPTURE: self.record,
            _CMD.VIDEO_STOP_CAPTURE: self.stop_recording,
            _CMD.DO_DIGICAM_CONTROL: self.control,
            _CMD.DO_SET_CAM_TRIGG_DIST: self.take_images_every,
            _CMD.SET_CAMERA_ZOOM: self.zoom,
            _CMD.SET_CAMERA_FOCUS: self.focus,
        }

    def take_images(self, request: CommandRequest) -> common.MavResult:
        """IMAGE_START_CAPTURE: every param 2 seconds, param 3 pictures; 0 runs until it is stopped."""
        period, count = number(request.command.param2), whole(number(request.command.param3))
        if count is None or count < 0 or (count != 1 and period <= 0):
            return _RESULT.DENIED
        self.payload.take_images(period, count or inf)
        return _RESULT.ACCEPTED

    def stop_images(self, request: CommandRequest) -> common.MavResult:
        """IMAGE_STOP_CAPTURE."""
        self.payload.stop_images()
        return _RESULT.ACCEPTED

    def record(self, request: CommandRequest) -> common.MavResult:
        """VIDEO_START_CAPTURE."""
        self.payload.recording = True
        return _RESULT.ACCEPTED

    def stop_recording(self, request: CommandRequest) -> common.MavResult:
        """VIDEO_STOP_CAPTURE."""
        self.payload.recording = False
        return _RESULT.ACCEPTED

    def control(self, request: CommandRequest) -> common.MavResult:
        """DO_DIGICAM_CONTROL: param 5 = 1 takes a picture."""
        if request.command.param5 != 1:
            return _RESULT.DENIED
        self.payload.take_image()
        return _RESULT.ACCEPTED

    def take_images_every(self, request: CommandRequest) -> common.MavResult:
        """DO_SET_CAM_TRIGG_DIST: every param 1 metres, 0 stops; param 3 = 1 takes one immediately."""
        distance = request.command.param1
        if not isfinite(distance) or distance < 0:
            return _RESULT.DENIED
        self.payload.take_images_every(distance)
        if request.command.param3 == 1:
            self.payload.take_image()
        return _RESULT.ACCEPTED

    def zoom(self, request: CommandRequest) -> common.MavResult:
        """SET_CAMERA_ZOOM."""
        if not isfinite(request.command.param2):
            return _RESULT.DENIED
        self.payload.zoom = request.command.param2
        return _RESULT.ACCEPTED

    def focus(self, request: CommandRequest) -> common.MavResult:
        """SET_CAMERA_FOCUS."""
        if not isfinite(request.command.param2):
            return _RESULT.DENIED
        self.payload.focus = request.command.param2
        return _RESULT.ACCEPTED


class GimbalCommands(CommandGroup):
    """The direction of the gimbal."""

    def handlers(self) -> Handlers:
        return {_CMD.DO_MOUNT_CONTROL: self.control_mount, _CMD.DO_GIMBAL_MANAGER_PITCHYAW: self.point}

    def control_mount(self, request: CommandRequest) -> common.MavResult:
        """DO_MOUNT_CONTROL: angles in degrees, in the mode of param 7."""
        command = request.command
        mode = whole(command.param7)
        if mode == common.MavMountMode.MAVLINK_TARGETING:
            pitch, roll, yaw = (
                radians(number(angle)) for angle in (command.param1, command.param2, command.param3)
            )
            self._look(Gimbal(roll, pitch, yaw))
        elif mode in (common.MavMountMode.RETRACT, common.MavMountMode.NEUTRAL):
            self._look(Gimbal())
        else:
            return _RESULT.DENIED
        return _RESULT.ACCEPTED

    def point(self, request: CommandRequest) -> common.MavResult:
        """DO_GIMBAL_MANAGER_PITCHYAW: pitch and yaw in degrees; the lock flag makes yaw relative to north."""
        command = request.command
        flags = whole(number(command.param5)) or 0
        if flags & (common.GimbalManagerFlags.RETRACT | common.GimbalManagerFlags.NEUTRAL):
            self._look(Gimbal())
            return _RESULT.ACCEPTED
        if (
            not (isfinite(command.param1) and isfinite(command.param2))
            or abs(command.param1) > _MAX_GLIDE_SLOPE
        ):
            return _RESULT.DENIED
        locked = bool(flags & common.GimbalManagerFlags.YAW_LOCK)
        self._look(Gimbal(0.0, radians(command.param1), radians(command.param2), yaw_locked=locked))
        return _RESULT.ACCEPTED

    def _look(self, gimbal: Gimbal) -> None:
        self.autopilot.payload.region_of_interest = None
        self.autopilot.payload.gimbal = gimbal
