"""Fixtures of the attacks on the command line."""

from __future__ import annotations

from tests.cli.conftest import mav, simulate

__all__ = ["mav", "simulate"]
