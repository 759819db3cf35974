"""The failure table of cameras and gimbals: one row for every call that waits."""

from __future__ import annotations

from typing import Any

from mavstack.errors import ActionTimeout, MessageTimeout, ParameterTimeout
from tests.vehicle.failures.rows import Call, Do, command
from tests.vehicle.failures.scripted_autopilot import CMD, RESULT, ScriptedHarness

NOT_WAITED = "it does not wait for the effect"
NO_PAYLOAD = "a component without such a payload refuses; then there is none"
NOT_REPORTED = (ActionTimeout, "accepted, but the gimbal does not report its attitude")
#: One code each: the commands of payloads have no rules of their own for the others.
CODES = (RESULT.TEMPORARILY_REJECTED,)


def camera(name: str, do: Do, number: int, **more: Any) -> Call:
    """Return the row of a call of a camera that sends a command."""
    more = {"why_not": NOT_WAITED} | more
    return command(f"Camera.{name}", do, number, codes=CODES, waits=False, **more)


def gimbal(name: str, do: Do, number: int, **more: Any) -> Call:
    """Return the row of a call of a gimbal that sends a command."""
    more = {"why_not": NOT_WAITED} | more
    return command(f"Gimbal.{name}", do, number, codes=CODES, waits=False, **more)


def report(name: str, do: Do, message: str) -> Call:
    """Return the row of a call that requests a message."""

    def refuse(harness: ScriptedHarness, code: int) -> None:
        harness.autopilot.refuse(CMD.REQUEST_MESSAGE, result=code)

    return Call(
        name,
        do,
        message,
        refuse,
        codes=CODES,
        waits=False,
        silent=MessageTimeout,
        why_not="it has no effect to wait for",
    )


CAMERA = [
    report("Camera.get_information", lambda h: h.camera.get_information(), "CAMERA_INFORMATION"),
    report("Camera.get_status", lambda h: h.camera.get_status(), "CAMERA_SETTINGS"),
    report("Camera.get_capture_status", lambda h: h.camera.get_capture_status(), "CAMERA_CAPTURE_STATUS"),
    report("Camera.list_storages", lambda h: h.camera.list_storages(), "STORAGE_INFORMATION"),
    report("Camera.list_streams", lambda h: h.camera.list_streams(), "VIDEO_STREAM_INFORMATION"),
    camera(
        "take_photo",
        lambda h: h.camera.take_photo(),
        CMD.IMAGE_START_CAPTURE,
        stuck=(MessageTimeout, "accepted, but the camera reported no image"),
    ),
    camera("start_photos", lambda h: h.camera.start_photos(1.0), CMD.IMAGE_START_CAPTURE),
    camera("stop_photos", lambda h: h.camera.stop_photos(), CMD.IMAGE_STOP_CAPTURE),
    camera("start_video", lambda h: h.camera.start_video(), CMD.VIDEO_START_CAPTURE),
    camera("stop_video", lambda h: h.camera.stop_video(), CMD.VIDEO_STOP_CAPTURE),
    camera("start_streaming", lambda h: h.camera.start_streaming(), CMD.VIDEO_START_STREAMING),
    camera("stop_streaming", lambda h: h.camera.stop_streaming(), CMD.VIDEO_STOP_STREAMING),
    camera("set_mode", lambda h: h.camera.set_mode("video"), CMD.SET_CAMERA_MODE),
    camera("set_zoom", lambda h: h.camera.set_zoom(5), CMD.SET_CAMERA_ZOOM),
    camera("set_focus", lambda h: h.camera.set_focus(5), CMD.SET_CAMERA_FOCUS),
    camera("format_storage", lambda h: h.camera.format_storage(), CMD.STORAGE_FORMAT),
    camera("reset_settings", lambda h: h.camera.reset_settings(), CMD.RESET_CAMERA_SETTINGS),
    camera("track_point", lambda h: h.camera.track_point(0.5, 0.5), CMD.CAMERA_TRACK_POINT),
    camera(
        "track_rectangle", lambda h: h.camera.track_rectangle(0.1, 0.1, 0.5, 0.5), CMD.CAMERA_TRACK_RECTANGLE
    ),
    camera("stop_tracking", lambda h: h.camera.stop_tracking(), CMD.CAMERA_STOP_TRACKING),
    report("CameraSettings.load", lambda h: h.camera.settings.load(), "CAMERA_INFORMATION"),
    Call(
        "CameraSettings.get",
        lambda h: h.camera.settings.get("CAM_NONE"),
        silent=ParameterTimeout,
        why_not="a camera without that setting does not answer",
    ),
    Call(
        "CameraSettings.set",
        lambda h: h.camera.settings.set("CAM_NONE", 1),
        silent=ParameterTimeout,
        why_not="tests of the node refuse settings",
    ),
]
GIMBAL = [
    report("Gimbal.get_information", lambda h: h.gimbal.get_information(), "GIMBAL_MANAGER_INFORMATION"),
    report("Gimbal.get_status", lambda h: h.gimbal.get_status(), "GIMBAL_MANAGER_STATUS"),
    gimbal("take_control", lambda h: h.gimbal.take_control(), CMD.DO_GIMBAL_MANAGER_CONFIGURE),
    gimbal("release_control", lambda h: h.gimbal.release_control(), CMD.DO_GIMBAL_MANAGER_CONFIGURE),
    gimbal("point", lambda h: h.gimbal.point(-20), CMD.DO_GIMBAL_MANAGER_PITCHYAW, stuck=NOT_REPORTED),
    gimbal("turn", lambda h: h.gimbal.turn(5), CMD.DO_GIMBAL_MANAGER_PITCHYAW),
    gimbal("center", lambda h: h.gimbal.center(), CMD.DO_GIMBAL_MANAGER_PITCHYAW, stuck=NOT_REPORTED),
    gimbal("retract", lambda h: h.gimbal.retract(), CMD.DO_GIMBAL_MANAGER_PITCHYAW, stuck=NOT_REPORTED),
    gimbal("set_roi", lambda h: h.gimbal.set_roi(47.4, 8.5), CMD.DO_SET_ROI_LOCATION),
    gimbal("set_roi_system", lambda h: h.gimbal.set_roi_system(2), CMD.DO_SET_ROI_SYSID),
    gimbal("clear_roi", lambda h: h.gimbal.clear_roi(), CMD.DO_SET_ROI_NONE),
]
VEHICLE = [
    Call(
        "Vehicle.find_cameras",
        lambda h: h.vehicle.find_cameras(),
        "CAMERA_INFORMATION",
        silent=MessageTimeout,
        why_not=NO_PAYLOAD,
    ),
    Call(
        "Vehicle.find_gimbals",
        lambda h: h.vehicle.find_gimbals(),
        "GIMBAL_MANAGER_INFORMATION",
        silent=MessageTimeout,
        why_not=NO_PAYLOAD,
    ),
    Call(
        "Vehicle.wait_for_camera",
        lambda h: h.vehicle.wait_for_camera(timeout=5),
        silent=None,
        why_not="it only waits for a heartbeat",
    ),
]
PAYLOAD_CALLS = [*CAMERA, *GIMBAL, *VEHICLE]
