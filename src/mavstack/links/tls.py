"""TLS links: `tls://host:port` connects, `tlsin://host:port` listens; TCP links inside TLS.

A client verifies the server's certificate against the system's authorities or against `ca=file.pem`, and its
name against the host or `server_name=…`; `insecure=yes` disables both and is for tests only. `cert=` and
`key=` are the client's own certificate. A server needs `cert=` and `key=`; with `ca=` it requires a
certificate of that authority from every client, whose subject is then the `identity` of the channel.
"""

from __future__ import annotations

import ssl
from typing import TYPE_CHECKING

from mavstack.errors import LinkError, LinkURLError
from mavstack.handshakes import Handshakes, TlsHandshake
from mavstack.links.tcp import TcpClient, TcpServer

if TYPE_CHECKING:
    import asyncio

    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL


class TlsServer(TcpServer):
    """A link that listens for TLS; every connection is a channel."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._context = server_context(url, options)
        self._handshakes = Handshakes()

    def _new_protocol(self) -> asyncio.Protocol:
        return TlsHandshake(super()._new_protocol(), self._context, self._handshakes)

    async def stop_transport(self) -> None:
        """Stop accepting peers and bytes."""
        await super().stop_transport()
        self._handshakes.close()


class TlsClient(TcpClient):
    """A link that connects to a TLS server."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._ssl = client_context(url, options)
        self._server_name = options.text("server_name", url.host)


def client_context(url: LinkURL, options: Options) -> ssl.SSLContext:
    """Create the TLS context of a client from the options of its URL."""
    ca, insecure = options.text("ca"), options.flag("insecure", default=False)
    context = ssl.create_default_context()
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    if ca:
        _load_authority(url, context, ca)
    if insecure:
        context.check_hostname = False
        context.verify_mode = ssl.CERT_NONE
    _load_certificate(url, context, options)
    return context


def server_context(url: LinkURL, options: Options) -> ssl.SSLContext:
    """Create the TLS context of a server from the options of its URL."""
    ca = options.text("ca")
    if not options.text("cert"):
        raise LinkURLError(f"{url.redacted} has no certificate: add ?cert=cert.pem&key=key.pem")
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    if ca:
        _load_authority(url, context, ca)
        context.verify_mode = ssl.CERT_REQUIRED
    _load_certificate(url, context, options)
    return context


def _load_authority(url: LinkURL, context: ssl.SSLContext, ca: str) -> None:
    try:
        context.load_verify_locations(ca)
    except OSError as error:
        raise LinkError(
            f"{url.redacted}: cannot read the certificate authority {ca}: {error.strerror or error}"
        ) from error


def _load_certificate(url: LinkURL, context: ssl.SSLContext, options: Options) -> None:
    cert, key = options.text("cert"), options.text("key")
    if not cert:
        return
    try:
        context.load_cert_chain(cert, key or None, password=_no_password)
    except (OSError, ValueError) as error:
        raise LinkError(f"{url.redacted}: cannot use the certificate {cert} with its key: {error}") from error


def _no_password() -> str:
    """Refuse an encrypted key; without this callback OpenSSL prompts on the terminal."""
    raise ValueError("the key is encrypted: store it without a password")
