"""Pictures that wait for the disk."""

from __future__ import annotations

import asyncio

import pytest

av = pytest.importorskip("av")
pytest.importorskip("aiortc")

from mavstack.server.video import late_pictures  # noqa: E402
from mavstack.server.video.late_pictures import LatePictures  # noqa: E402


@pytest.fixture(autouse=True)
def bound(monkeypatch):
    monkeypatch.setattr(late_pictures, "MAX_WAITING", 5000)


def packet(number, size=1000, *, is_key=False):
    found = av.Packet(bytes(size))
    found.pts, found.is_keyframe = number, is_key
    return found


async def numbers(pictures):
    """Return the numbers of the pictures that wait."""
    return [(await pictures.get()).pts for _ in range(len(pictures))]


async def test_pictures_wait_in_their_order_up_to_the_bound():
    pictures = LatePictures()
    for number in range(5):
        pictures.put(packet(number, is_key=not number))
    assert await numbers(pictures) == [0, 1, 2, 3, 4]
    for number in range(5, 10):  # the bytes of pictures that were taken count no more
        pictures.put(packet(number))
    assert await numbers(pictures) == [5, 6, 7, 8, 9]
    assert pictures.dropped == 0


async def test_too_many_are_dropped_until_the_next_picture_that_needs_no_other():
    pictures = LatePictures()
    for number in range(18):
        pictures.put(packet(number, is_key=number % 10 == 0))
    assert (len(pictures), pictures.dropped) == (0, 18)
    for number in range(18, 23):
        pictures.put(packet(number, is_key=number % 10 == 0))
    assert await numbers(pictures) == [20, 21, 22]
    assert pictures.dropped == 20


async def test_a_picture_that_needs_no_other_is_kept_when_it_is_one_too_many():
    pictures = LatePictures()
    for number in range(7):
        pictures.put(packet(number, is_key=number in (0, 5)))
    assert await numbers(pictures) == [5, 6]
    assert pictures.dropped == 5


async def test_one_picture_may_exceed_the_bound():
    pictures = LatePictures()
    for number in range(2):
        pictures.put(packet(number, 9000, is_key=not number))
        assert await numbers(pictures) == [number]
    assert pictures.dropped == 0


async def test_decoded_pictures_need_no_other():
    pictures = LatePictures()
    size = sum(plane.buffer_size for plane in av.VideoFrame(64, 32, "gray").planes)
    assert 2000 < size < 2500, "two fit, three do not"
    for number in range(4):
        frame = av.VideoFrame(64, 32, "gray")
        frame.pts = number
        pictures.put(frame)
    assert await numbers(pictures) == [2, 3]
    assert pictures.dropped == 2


async def test_the_end_comes_after_the_pictures_that_wait():
    pictures = LatePictures()
    waiting = asyncio.create_task(pictures.get())
    await asyncio.sleep(0)
    pictures.put(packet(0, is_key=True))
    pictures.put(packet(1))
    pictures.end()
    assert (await waiting).pts == 0
    assert (await pictures.get()).pts == 1
    assert await pictures.get() is None
