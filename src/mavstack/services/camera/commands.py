"""The commands of the camera protocol; each takes the device id of an attached camera, 0 for the others."""

from __future__ import annotations

from math import nan

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.arguments import check_number
from mavstack.services.command import Command

_CMD, _ZOOM, _FOCUS = common.MavCmd, common.CameraZoomType, common.SetFocusType
#: The id that means all storages or all streams.
ALL = 0
#: The range of values of each type of zoom and focus.
_LIMITS: dict[int, tuple[float, float]] = {
    int(_ZOOM.STEP): (-1.0, 1.0),
    int(_ZOOM.CONTINUOUS): (-1.0, 1.0),
    int(_ZOOM.RANGE): (0.0, 100.0),
}
_AUTOFOCUS = (_FOCUS.AUTO, _FOCUS.AUTO_SINGLE, _FOCUS.AUTO_CONTINUOUS)


def start_images(device_id: int, *, interval: float = 0.0, count: int = 1, sequence: int = 0) -> Command:
    """Return IMAGE_START_CAPTURE.

    Args:
        device_id: The attached camera, or 0.
        interval: Seconds between two images.
        count: The number of images; 0: until it is stopped.
        sequence: The number of the request for a single image, from 1; 0 for several.

    Returns:
        The command.

    Raises:
        InvalidArgumentError: The interval is negative, or 0 for several images, or the count is negative.
    """
    check_number("interval", interval)
    if interval < 0 or count < 0 or (count != 1 and interval <= 0):
        raise InvalidArgumentError(
            f"a series of images needs an interval above 0 s and a count of at least 0, "
            f"got {interval:g} s and {count}"
        )
    return Command(_CMD.IMAGE_START_CAPTURE, device_id, interval, count, sequence)


def stop_images(device_id: int) -> Command:
    """Return IMAGE_STOP_CAPTURE."""
    return Command(_CMD.IMAGE_STOP_CAPTURE, device_id, nan, nan, nan, 0.0, 0.0, nan)


def start_video(device_id: int, *, stream: int = ALL, status_rate: float = 1.0) -> Command:
    """Return VIDEO_START_CAPTURE; CAMERA_CAPTURE_STATUS is sent at `status_rate` hertz meanwhile."""
    check_number("status_rate", status_rate)
    if status_rate < 0:
        raise InvalidArgumentError(f"status_rate must be at least 0 Hz, got {status_rate:g}")
    return Command(_CMD.VIDEO_START_CAPTURE, stream, status_rate, device_id)


def stop_video(device_id: int, *, stream: int = ALL) -> Command:
    """Return VIDEO_STOP_CAPTURE."""
    return Command(_CMD.VIDEO_STOP_CAPTURE, stream, device_id)


def start_streaming(device_id: int, stream: int) -> Command:
    """Return VIDEO_START_STREAMING."""
    return Command(_CMD.VIDEO_START_STREAMING, stream, device_id)


def stop_streaming(device_id: int, stream: int) -> Command:
    """Return VIDEO_STOP_STREAMING."""
    return Command(_CMD.VIDEO_STOP_STREAMING, stream, device_id)


def set_mode(device_id: int, mode: int) -> Command:
    """Return SET_CAMERA_MODE."""
    return Command(_CMD.SET_CAMERA_MODE, device_id, mode, nan, nan, 0.0, 0.0, nan)


def set_zoom(device_id: int, value: float, kind: int = _ZOOM.RANGE) -> Command:
    """Return SET_CAMERA_ZOOM; the meaning of the value depends on the CAMERA_ZOOM_TYPE.

    Raises:
        InvalidArgumentError: The value is out of the range of its type.
    """
    _check_range("zoom", value, kind)
    return Command(_CMD.SET_CAMERA_ZOOM, kind, value, device_id, nan)


def set_focus(device_id: int, value: float, kind: int = _FOCUS.RANGE) -> Command:
    """Return SET_CAMERA_FOCUS; the meaning of the value depends on the SET_FOCUS_TYPE.

    Raises:
        InvalidArgumentError: The value is out of the range of its type.
    """
    if kind not in _AUTOFOCUS:
        _check_range("focus", value, kind)
    return Command(_CMD.SET_CAMERA_FOCUS, kind, value, device_id, nan)


def format_storage(storage: int, *, reset_image_log: bool = False, erase: bool = True) -> Command:
    """Return STORAGE_FORMAT; without `erase` only the image log is reset."""
    return Command(_CMD.STORAGE_FORMAT, storage, float(erase), float(reset_image_log))


def reset_settings(device_id: int) -> Command:
    """Return RESET_CAMERA_SETTINGS."""
    return Command(_CMD.RESET_CAMERA_SETTINGS, 1.0, device_id)


def track_point(device_id: int, x: float, y: float, radius: float = 0.0) -> Command:
    """Return CAMERA_TRACK_POINT; x, y and radius are shares of the image, 0 to 1.

    Raises:
        InvalidArgumentError: A value is not from 0 to 1.
    """
    _check_shares(x=x, y=y, radius=radius)
    return Command(_CMD.CAMERA_TRACK_POINT, x, y, radius, device_id)


def track_rectangle(device_id: int, left: float, top: float, right: float, bottom: float) -> Command:
    """Return CAMERA_TRACK_RECTANGLE; the corners are shares of the image, 0 to 1.

    Raises:
        InvalidArgumentError: A value is not from 0 to 1, or the rectangle is empty.
    """
    _check_shares(left=left, top=top, right=right, bottom=bottom)
    if left >= right or top >= bottom:
        raise InvalidArgumentError("a rectangle needs left < right and top < bottom; y grows downwards")
    return Command(_CMD.CAMERA_TRACK_RECTANGLE, left, top, right, bottom, device_id)


def stop_tracking(device_id: int) -> Command:
    """Return CAMERA_STOP_TRACKING."""
    return Command(_CMD.CAMERA_STOP_TRACKING, device_id)


def _check_range(name: str, value: float, kind: int) -> None:
    check_number(name, value)
    first, last = _LIMITS.get(int(kind), (0.0, float("inf")))
    if not first <= value <= last:
        raise InvalidArgumentError(f"{name} must be from {first:g} to {last:g} for this type, got {value:g}")


def _check_shares(**values: float) -> None:
    for name, value in values.items():
        check_number(name, value)
        if not 0.0 <= value <= 1.0:
            raise InvalidArgumentError(f"{name} must be a share of the image from 0 to 1, got {value:g}")
