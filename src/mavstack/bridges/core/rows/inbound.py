"""All rows to the vehicle."""

from __future__ import annotations

from typing import Final

from mavstack.bridges.core.rows import estimates, inputs, setpoints

ROWS: Final = (*setpoints.ROWS, *estimates.ROWS, *inputs.ROWS)
