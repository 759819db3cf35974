"""Units of aviation in those of the SI."""

from __future__ import annotations

from typing import Final

FEET: Final = 0.3048
KNOTS: Final = 1852 / 3600
FEET_PER_MINUTE: Final = FEET / 60
