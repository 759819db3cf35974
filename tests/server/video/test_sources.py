"""Codecs of open cameras."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest

from mavstack.server.video.addresses import CameraAddress

MediaStreamError = pytest.importorskip("aiortc.mediastreams").MediaStreamError
av = pytest.importorskip("av")

from mavstack.server.video.late_pictures import LatePictures  # noqa: E402
from mavstack.server.video.sources import open_source  # noqa: E402
from mavstack.server.video.video_file import VideoFile  # noqa: E402

COUNT = 12


def make_video(path, codec):
    """Write a video of some pictures."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, rate=30)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        for number in range(COUNT):
            picture = av.VideoFrame.from_ndarray(np.full((48, 64, 3), 20 * number, np.uint8), format="rgb24")
            container.mux(stream.encode(picture))
        container.mux(stream.encode(None))


async def record(path, file):
    """Record a camera to its end; return the codec that it passes on, and the number of damaged packets."""
    source = await open_source(CameraAddress(url=str(path)), passes_h264=True)
    track, pictures, written = source.subscribe(), LatePictures(), VideoFile(file)
    try:
        async with asyncio.timeout(20):
            while source.is_live:
                pictures.put(await track.recv())
                written.write(await pictures.get())
    except MediaStreamError:
        pass
    finally:
        track.stop()
        await source.close()
        written.close()
    return source.codec, written.damaged


@pytest.mark.parametrize(
    ("codec", "name", "passed_on"),
    [("libx264", "camera.ts", "h264"), ("libvpx", "camera.webm", ""), ("mpeg4", "camera.mkv", "")],
)
async def test_only_h264_is_passed_on(tmp_path, codec, name, passed_on):
    make_video(tmp_path / name, codec)
    file = tmp_path / "recorded.mp4"
    file.touch()
    found, damaged = await record(tmp_path / name, file)
    assert (found, damaged) == (passed_on, 0)
    with av.open(str(file)) as container:
        assert container.streams.video[0].codec_context.name == "h264"
        assert len(list(container.decode(video=0))) >= COUNT - 2
