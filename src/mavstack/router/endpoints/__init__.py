"""The endpoints of a router by the scheme of their URL."""

from __future__ import annotations

from mavstack.router.endpoints.base import CLOSED, DOWN, ENDED, LISTENING, OPEN, Endpoint
from mavstack.router.endpoints.factory import make_endpoint

__all__ = ["CLOSED", "DOWN", "ENDED", "LISTENING", "OPEN", "Endpoint", "make_endpoint"]
