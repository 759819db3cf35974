"""What all tests share: no test of properties may fail because the machine is slow."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("mavstack", deadline=None)
settings.load_profile("mavstack")
