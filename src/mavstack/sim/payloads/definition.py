"""The camera definition file of simulated cameras."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from mavstack.services.camera import CameraDefinition, read_definition

VERSION = 1
TEXT = (files(__package__) / "camera_definition.xml").read_text("utf-8")


@cache
def simulated_definition() -> CameraDefinition:
    """Return the settings of simulated cameras."""
    return read_definition(TEXT.encode())
