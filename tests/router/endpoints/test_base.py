"""The base of endpoints."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mavstack.router.endpoints.base import Endpoint


@pytest.mark.parametrize(
    ("address", "shown"),
    [(("0.0.0.0", 14550), "0.0.0.0:14550"), (("::1", 14550), "[::1]:14550"), (None, "")],
    ids=["IPv4", "IPv6", "no port"],
)
def test_the_address_is_shown_as_in_urls(address, shown):
    assert Endpoint.listens_on.fget(SimpleNamespace(address=address)) == shown
