"""Fuzz target of sealed links: any datagrams and any bytes of a stream are counted, and close no session.

Run by `rust/fuzz/run`; needs `pip install atheris`.
"""

import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["mavstack.security.sealed"]):
    from mavstack.security.sealed import cobs
    from tests.security.sealed.network import Network

NETWORK = Network()
NETWORK.ends = [NETWORK.both(), NETWORK.both()]
NETWORK.run(3.0)


def receive(data: bytes) -> None:
    """Let both ends receive the datagrams of one stream."""
    datagrams = cobs.Decoder().feed(data + b"\0")
    for datagram in [data, *datagrams]:
        for receiver in (0, 1):
            NETWORK.inject(receiver, datagram)
    NETWORK.run(0.01, 0.01)
    assert NETWORK.received == ([], [])
    assert all(tunnel.is_open for tunnel in NETWORK.ends)
    NETWORK.recorded.clear()


if __name__ == "__main__":
    corpus = Path(tempfile.mkdtemp())
    for number, (_, datagram) in enumerate(NETWORK.recorded):
        (corpus / str(number)).write_bytes(datagram)
        (corpus / f"{number} framed").write_bytes(cobs.encode(datagram))
    NETWORK.run(30.0)  # the recorded messages are old by now
    atheris.Setup([*sys.argv, str(corpus)], receive)
    atheris.Fuzz()
