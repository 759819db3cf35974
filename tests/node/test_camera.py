"""A camera of a remote component, against one that a node offers."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import (
    CommandDenied,
    DialectError,
    InvalidArgumentError,
    ParameterDenied,
    RemoteDenied,
)
from tests.node.payload import PayloadPair, with_pair
from tests.services.camera.test_definition import FILE


def test_reports() -> None:
    async def work(pair: PayloadPair) -> None:
        camera = pair.camera
        assert camera.information is None
        assert repr(camera) == "<Camera 1/100>"
        information = await camera.get_information()
        assert (information.vendor, information.model) == ("Maker", "T1")
        assert camera.information == information
        assert (await camera.get_status()).mode == common.CameraMode.IMAGE
        assert not (await camera.get_capture_status()).recording
        assert [each.available for each in await camera.list_storages()] == [900.0]
        assert [each.name for each in await camera.list_streams()] == ["day", "heat"]
        assert sorted(camera.streams) == [1, 2]
        assert sorted(camera.storages) == [1]
        assert await pair.remote.list_cameras() == (camera,)

    with_pair(work)


def test_images() -> None:
    async def work(pair: PayloadPair) -> None:
        camera = pair.camera
        async with camera.images() as images:
            image = await camera.take_photo()
            assert image.index == 0
            assert (await anext(images)).image == image
            await camera.start_photos(0.5, count=3)
            assert [(await anext(images)).image.index for _ in range(3)] == [1, 2, 3]
            await camera.start_photos(1.0)
            await asyncio.sleep(2.5)
            await camera.stop_photos()
        assert camera.capture_status.interval is None
        assert camera.capture_status.image_count == 7

    with_pair(work)


def test_video_mode_lens_and_tracking() -> None:
    async def work(pair: PayloadPair) -> None:
        camera = pair.camera
        with pytest.raises(CommandDenied, match="VIDEO_START_CAPTURE on 1/100 failed: TEMPORARILY_REJECTED"):
            await camera.start_video()
        await camera.set_mode("video")
        await camera.start_video()
        await asyncio.sleep(2)
        assert camera.capture_status.recording
        await camera.stop_video()
        await camera.start_streaming(2)
        await camera.stop_streaming(1)
        await camera.set_zoom(30)
        await camera.set_focus(kind=common.SetFocusType.AUTO)
        assert camera.status.zoom == 30
        await camera.track_point(0.5, 0.25)
        await asyncio.sleep(1)
        assert camera.tracked.point == (0.5, 0.25)
        await camera.track_rectangle(0.25, 0.25, 0.5, 0.5)
        await camera.stop_tracking()
        await camera.reset_settings()
        await camera.format_storage()
        assert pair.device.used == 0.0

    with_pair(work)


def test_settings() -> None:
    async def work(pair: PayloadPair) -> None:
        settings = pair.camera.settings
        with pytest.raises(InvalidArgumentError, match="was not loaded"):
            settings.options("CAM_ISO")
        definition = await settings.load()
        assert definition.model == "T1"
        assert settings.values["CAM_ISO"] == 100
        assert "CAM_VIDRES" not in settings.available
        assert await settings.set("CAM_EXPMODE", "Auto") == 0
        assert "CAM_ISO" not in settings.available
        with pytest.raises(InvalidArgumentError, match="CAM_ISO has no effect with Auto"):
            await settings.set("CAM_ISO", 200)
        await settings.set("CAM_EXPMODE", "Manual")
        assert await settings.set("CAM_ISO", "800") == 800
        assert await settings.get("CAM_ISO") == 800
        assert dict(settings.options("CAM_VIDRES")) == {"4K": 0, "HD": 1}
        assert await settings.set("CAM_IRLOCK", "on") == 1

    with_pair(work)


def test_settings_without_a_definition_are_checked_by_the_camera() -> None:
    async def work(pair: PayloadPair) -> None:
        settings = pair.camera.settings
        with pytest.raises(ParameterDenied):
            await settings.set("CAM_ISO", 3)
        assert await settings.set("CAM_ISO", 200) == 200

    with_pair(work)


@pytest.mark.parametrize(
    ("uri", "error", "problem"),
    [
        ("", RemoteDenied, "1/100 failed: the camera has no definition file"),
        ("http://camera/a.xml", RemoteDenied, "the definition is at http://camera/a.xml; download it"),
        ("mftp:///broken.xml", DialectError, "broken.xml"),
    ],
)
def test_definitions_that_cannot_be_loaded(uri: str, error: type, problem: str) -> None:
    async def work(pair: PayloadPair) -> None:
        with pytest.raises(error, match=problem):
            await pair.camera.settings.load()
        assert (await pair.camera.settings.load(FILE)).model == "T1"

    with_pair(work, uri=uri)


def test_arguments_are_checked_before_anything_is_sent() -> None:
    async def work(pair: PayloadPair) -> None:
        with pytest.raises(InvalidArgumentError, match="photo, video or survey, got 'night'"):
            await pair.camera.set_mode("night")
        with pytest.raises(InvalidArgumentError, match="positive interval"):
            await pair.camera.start_photos(0.0)
        with pytest.raises(InvalidArgumentError, match="ids from 1 to 6"):
            pair.remote.attached_camera(7)
        assert pair.remote.attached_camera(2) is pair.remote.attached_camera(2)

    with_pair(work)
