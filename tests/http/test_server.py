from __future__ import annotations

import pytest
from starlette.applications import Starlette

from mavstack.errors import LinkError
from mavstack.http.server import Certificate, serving


async def test_an_address_in_use_is_an_error():
    async with serving(Starlette(), "127.0.0.1:0", name="a service") as (host, port):
        with pytest.raises(LinkError, match=r"cannot serve another service on .*in use"):
            async with serving(Starlette(), f"{host}:{port}", name="another service"):
                pass


async def test_a_missing_certificate_is_an_error():
    with pytest.raises(
        LinkError, match=r"with TLS: missing.pem is not a certificate with its key \(No such file"
    ):
        async with serving(Starlette(), "127.0.0.1:0", name="a service", tls=Certificate("missing.pem")):
            pass
