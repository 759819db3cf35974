"""Fuzz target of WebSocket tickets: any header is refused with a reason, unless it has the one valid ticket.

Run by `rust/fuzz/run`; needs `pip install atheris`.
"""

import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["mavstack.security.tickets"]):
    from mavstack.security.tickets import SUBPROTOCOL, TicketVerifier, make_ticket, offered_ticket

VALID = make_ticket("ados_secret", now=1_000_000, nonce=bytes(16))


def verify(data: bytes) -> None:
    """Verify the ticket in one header, twice."""
    ticket = offered_ticket(data.decode("utf-8", "surrogateescape"))
    if ticket is None:
        return
    verifier = TicketVerifier("ados_secret")
    assert (verifier.verify(ticket, 1_000_000) is None) == (ticket == VALID)
    assert verifier.verify(ticket, 1_000_000)


if __name__ == "__main__":
    corpus = Path(tempfile.mkdtemp())
    (corpus / "valid").write_text(f"{SUBPROTOCOL}, {VALID}")
    atheris.Setup([*sys.argv, str(corpus)], verify)
    atheris.Fuzz()
