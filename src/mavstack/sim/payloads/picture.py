"""The picture of a simulated camera: horizon by the attitude of the vehicle, and the time in a row of blocks.

The blocks are a number of 48 bits, the first one the highest: milliseconds since 1970. They survive the
compression of video, so that a viewer, or a test, measures the delay of the whole way.
"""

from __future__ import annotations

from math import cos, radians, sin, tan
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

WIDTH: Final = 640
HEIGHT: Final = 360
TIME_BITS: Final = 48
#: Height in pixels of the row of blocks that encodes data in the picture.
BLOCK_HEIGHT: Final = 16
#: Half of the vertical field of view, in degrees.
_HALF_VIEW: Final = 25.0
_SKY: Final = (70, 130, 200)
_GROUND: Final = (110, 85, 50)
_MARK: Final = (255, 220, 0)
_MIDDLE: Final = 128


def draw(time: float, roll: float, pitch: float) -> NDArray[np.uint8]:
    """Draw a picture.

    Args:
        time: Unix time in seconds.
        roll: Roll in radians.
        pitch: Pitch in radians.

    Returns:
        Rows, columns and RGB.
    """
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH].astype(np.float32)
    right, down = columns - WIDTH / 2, rows - HEIGHT / 2
    scale = HEIGHT / 2 / tan(radians(_HALF_VIEW))
    below = down * cos(roll) + right * sin(roll) - scale * tan(max(min(pitch, 1.2), -1.2))
    picture = np.where(below[..., None] > 0, np.array(_GROUND, np.uint8), np.array(_SKY, np.uint8))
    picture[HEIGHT // 2 - 1 : HEIGHT // 2 + 1, WIDTH // 2 - 60 : WIDTH // 2 + 60] = _MARK
    _draw_time(picture, int(time * 1000))
    return picture


def read_time(picture: NDArray[np.uint8]) -> float:
    """Return the Unix time of a picture in seconds, from its blocks; the picture may have any size."""
    height, width = picture.shape[:2]
    row = picture[int(height * BLOCK_HEIGHT / HEIGHT) // 2]
    places = ((np.arange(TIME_BITS) + 0.5) * width / TIME_BITS).astype(int)
    bits = row[places].reshape(TIME_BITS, -1).mean(axis=1) > _MIDDLE
    return int("".join("01"[int(bit)] for bit in bits), 2) / 1000


def _draw_time(picture: NDArray[np.uint8], number: int) -> None:
    edges = (np.arange(TIME_BITS + 1) * WIDTH / TIME_BITS).astype(int)
    for index in range(TIME_BITS):
        bit = number >> (TIME_BITS - 1 - index) & 1
        picture[:BLOCK_HEIGHT, edges[index] : edges[index + 1]] = 255 * bit
