"""The reports of a camera, for people and as JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.dialects import common
from mavstack.errors import RemoteDenied, RemoteTimeout
from mavstack.services.camera import mode_name

if TYPE_CHECKING:
    from collections.abc import Awaitable, Sequence

    from mavstack.node.camera import Camera
    from mavstack.services.camera import CapturedImage, CaptureStatus, Storage, VideoStream

_CAPS = common.CameraCapFlags
_ABILITIES = {
    "images": _CAPS.CAPTURE_IMAGE,
    "video": _CAPS.CAPTURE_VIDEO,
    "streams": _CAPS.HAS_VIDEO_STREAM,
    "modes": _CAPS.HAS_MODES,
    "zoom": _CAPS.HAS_BASIC_ZOOM,
    "focus": _CAPS.HAS_BASIC_FOCUS,
    "tracking": _CAPS.HAS_TRACKING_POINT | _CAPS.HAS_TRACKING_RECTANGLE,
    "thermal range": _CAPS.HAS_THERMAL_RANGE,
}


async def show_information(camera: Camera, *, as_json: bool) -> None:
    """Print everything that a camera reports about itself."""
    information = await camera.get_information()
    status = await _optional(camera.get_status())
    capture = await _optional(camera.get_capture_status())
    storages: Sequence[Storage] = await _optional(camera.list_storages()) or ()
    streams: Sequence[VideoStream] = await _optional(camera.list_streams()) or ()
    abilities = [name for name, flags in _ABILITIES.items() if information.capabilities & flags]
    if as_json:
        echo_json(
            {
                "camera": str(camera.address),
                "device_id": camera.device_id,
                "information": asdict(information),
                "abilities": abilities,
                "status": status and {**asdict(status), "mode": mode_name(status.mode)},
                "capture": capture and asdict(capture),
                "storages": [asdict(each) for each in storages],
                "streams": [asdict(each) for each in streams],
            }
        )
        return
    rows = [("camera", f"{information.vendor} {information.model}".strip() or "unnamed")]
    rows += [("address", f"{camera.address}" + (f", device {camera.device_id}" if camera.device_id else ""))]
    rows += [("firmware", information.firmware)] if information.firmware else []
    if information.width:
        rows += [("resolution", f"{information.width} x {information.height}")]
    rows += [("abilities", ", ".join(abilities) or "none")]
    if status is not None:
        lens = [
            f"{name} {value:.0f} %"
            for name, value in (("zoom", status.zoom), ("focus", status.focus))
            if value is not None
        ]
        rows += [("mode", ", ".join([mode_name(status.mode), *lens]))]
    rows += [("captures", capture_text(capture))] if capture is not None else []
    rows += [(f"storage {each.id}", storage_text(each)) for each in storages]
    rows += [(f"stream {each.id}", stream_text(each)) for each in streams]
    echo(*align_columns(rows))


def show_image(image: CapturedImage, *, as_json: bool) -> None:
    """Print an image."""
    if as_json:
        echo_json(asdict(image))
        return
    place = f"{image.latitude:.6f}, {image.longitude:.6f}, {image.altitude:.1f} m above sea"
    outcome = "" if image.success else "FAILED, "
    echo(f"image {image.index}: {outcome}{place}" + (f", {image.url}" if image.url else ""))


def capture_text(status: CaptureStatus) -> str:
    """Return the capture status in words."""
    parts = [f"{status.image_count} images"]
    parts += [f"one every {status.interval:g} s"] if status.interval is not None else []
    parts += [f"recording since {status.recording_time:.0f} s"] if status.recording else []
    return ", ".join(parts)


def storage_text(storage: Storage) -> str:
    """Return a storage in words."""
    known = {int(each): each.name.lower().replace("_", " ") for each in common.StorageStatus}
    if storage.status != common.StorageStatus.READY:
        return known.get(storage.status, str(storage.status))
    name = f"{storage.name}, " if storage.name else ""
    return f"{name}{storage.available:.0f} of {storage.total:.0f} MiB free"


def stream_text(stream: VideoStream) -> str:
    """Return a video stream in words."""
    state = "" if stream.running else ", stopped"
    name = f"{stream.name}, " if stream.name else ""
    return f"{name}{stream.width} x {stream.height} at {stream.frame_rate:g} Hz, {stream.uri}{state}"


async def _optional(report: Awaitable[Any]) -> Any:  # noqa: ANN401 (the type of any report)
    """Return a report; None if the camera does not make it."""
    try:
        return await report
    except (RemoteDenied, RemoteTimeout):
        return None
