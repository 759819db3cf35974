"""Locations on the Earth; `mavstack.geodesy` has the distances between them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Location:
    """A target location: degrees, and metres above home (None: the present altitude)."""

    latitude: float
    longitude: float
    altitude: float | None = None
