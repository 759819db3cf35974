"""The subject of the certificate that a TLS client showed, as text: `CN=ground-1,O=Fleet`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    import asyncio

_SHORT_NAMES: Final = {
    "commonName": "CN",
    "organizationName": "O",
    "organizationalUnitName": "OU",
    "countryName": "C",
    "localityName": "L",
    "stateOrProvinceName": "ST",
    "emailAddress": "emailAddress",
}


def client_subject(transport: asyncio.BaseTransport) -> str:
    """Return the subject of the certificate of a peer; empty without TLS or without a verified certificate.

    Separators within a value are escaped, so that no name can look like several.
    """
    certificate = transport.get_extra_info("peercert") or {}
    fields = (pair for names in certificate.get("subject", ()) for pair in names)
    return ",".join(f"{_SHORT_NAMES.get(name, name)}={_escape(value)}" for name, value in fields)


def _escape(value: str) -> str:
    shown = "".join(each if each.isprintable() else "\N{REPLACEMENT CHARACTER}" for each in value)
    for character in "\\,=+":
        shown = shown.replace(character, "\\" + character)
    return shown
