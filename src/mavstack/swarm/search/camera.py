"""The ground that a camera sees, and the track spacing that follows from it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from mavstack.errors import InvalidArgumentError


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera that looks straight down.

    Attributes:
        horizontal_view: Angle of view across the direction of flight, in degrees.
        vertical_view: Angle of view along it, in degrees.
        width: Pixels across the direction of flight; 0: unknown.
    """

    horizontal_view: float = 73.7
    vertical_view: float = 53.1
    width: int = 0

    def __post_init__(self) -> None:
        for name, value in (("horizontal_view", self.horizontal_view), ("vertical_view", self.vertical_view)):
            if not 0.0 < value < 180.0:
                raise InvalidArgumentError(
                    f"{name} must be more than 0 and less than 180 degrees, got {value:g}"
                )

    def footprint(self, height: float) -> tuple[float, float]:
        """Return the metres across and along the direction of flight that a picture shows.

        Args:
            height: Metres above ground.
        """
        if not (math.isfinite(height) and height > 0.0):
            raise InvalidArgumentError(f"height must be finite and more than 0 m, got {height:g}")
        return (
            2.0 * height * math.tan(math.radians(self.horizontal_view) / 2.0),
            2.0 * height * math.tan(math.radians(self.vertical_view) / 2.0),
        )

    def spacing(self, height: float, sidelap: float) -> float:
        """Return the metres between tracks whose pictures overlap.

        Args:
            height: Metres above ground.
            sidelap: Part of a picture that the next track shows too, 0 to less than 1.
        """
        return self.footprint(height)[0] * _rest(sidelap)

    def trigger_distance(self, height: float, frontlap: float) -> float:
        """Return the metres between pictures of one track that overlap.

        Args:
            height: Metres above ground.
            frontlap: Part of a picture that the next one shows too, 0 to less than 1.
        """
        return self.footprint(height)[1] * _rest(frontlap)

    def pixel_size(self, height: float) -> float | None:
        """Return the metres of ground in a pixel; None without `width`."""
        return self.footprint(height)[0] / self.width if self.width else None


def _rest(overlap: float) -> float:
    if not 0.0 <= overlap < 1.0:
        raise InvalidArgumentError(f"overlap must be at least 0 and less than 1, got {overlap:g}")
    return 1.0 - overlap
