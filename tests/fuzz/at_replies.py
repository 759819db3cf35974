"""Fuzz target of the replies of SiK radios: any bytes end every operation of a session, in bounded memory.

Run by `rust/fuzz/run`; needs `pip install atheris`.
"""

import sys

import atheris

with atheris.instrument_imports(include=["mavstack.radio"]):
    from mavstack.errors import RadioError
    from mavstack.radio.replies import parse_parameters, parse_rssi
    from mavstack.radio.session import MAX_LINES, AtCommand, AtSession, Mode, Reply

FRAGMENTS = [
    b"OK\r\n",
    b"ERROR\r\n",
    b"RTI5\r\n",
    b"S3: NETID=25\r\n",
    b"[1] S4:TXPOWER(N)=20\r\n",
    b"L/R RSSI: 180/176  L/R noise: 50/48 pkts: 1  txe=0 rxe=0 stx=0 srx=0 ecc=0/0 temp=31 dco=0\r\n",
    b"\xfd\x09\x00",
]


def finish(session: AtSession, data: bytes, now: float) -> float:
    """Feed bytes to an operation until it ends."""
    for step in range(40):
        if session.done:
            return now
        session.receive(data[step * 8 : step * 8 + 8] if step < 20 else b"", now)
        deadline = session.next_timeout()
        if not session.done and deadline is not None:
            now = max(now, deadline)
            session.handle_timeout(now)
    raise RuntimeError("the operation does not end")


def converse(data: bytes) -> None:
    """Enter command mode, and run a command of each kind with the bytes as replies."""
    replies = b"".join(FRAGMENTS[byte] if byte < len(FRAGMENTS) else bytes([byte]) for byte in data)
    session = AtSession(0.0)
    session.enter(0.0)
    now = finish(session, replies, 0.0)
    for reply in Reply if session.mode is Mode.READY else ():
        session.start(AtCommand("RTI5", reply), now)
        now = finish(session, replies, now)
        try:
            lines = session.result()
        except RadioError:
            continue
        if len(lines) > MAX_LINES:
            raise RuntimeError("more lines than a reply may have")
        parse_parameters(lines)
        for line in lines:
            parse_rssi(line)
    session.leave(now)
    finish(session, b"", now)


if __name__ == "__main__":
    atheris.Setup(sys.argv, converse)
    atheris.Fuzz()
