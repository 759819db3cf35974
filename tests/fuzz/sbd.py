"""Fuzz target of short burst data: any bytes of a modem, of its program, and of the gateway's web hook.

After any bytes of its modem a session recovers: the next message reaches the gateway. Run by `rust/fuzz/run`;
needs `pip install atheris`.
"""

import sys

import atheris

with atheris.instrument_imports(include=["mavstack.links.sbd_modem", "mavstack.links.rockblock_api"]):
    from mavstack.links.rockblock_api import failure_of, parse_hook
    from mavstack.links.sbd_modem import MAX_RECEIVED, MAX_SENT, SbdModem

from mavstack.radio.sbd_simulator import SimulatedSbdModem

#: A byte below their number stands for one of them.
FRAGMENTS = [
    b"\r\nOK\r\n",
    b"\r\nERROR\r\n",
    b"\r\nREADY\r\n",
    b"0\r\n",
    b"\r\nSBDRING\r\n",
    b"+SBDIX: 0, 1, 1, 2, 5, 3\r\n",
    b"+SBDIX: 32, 0, 2, 0, 0, 0\r\n",
    b"\x00\x02ab\x00\xc3",
]
MESSAGE = b"the message after the noise"
#: Steps after which a message has reached the gateway, and the largest repetition of a session is over.
MAX_STEPS = 400


def converse(modem: SbdModem, data: bytes) -> float:
    """Let a modem answer with the bytes; return the time at the end."""
    now = 0.0
    for at in range(0, len(data), 5):
        modem.receive(data[at : at + 5], now)
        modem.data_to_send()
        if any(len(message) > MAX_RECEIVED for message in modem.take()):
            raise RuntimeError("a message is larger than the gateway sends")
        due = modem.next_timeout()
        if due is not None and data[at] & 1:
            now = max(now, due)
            modem.handle_timeout(now)
    return now


def recover(modem: SbdModem, now: float) -> None:
    """Let the session continue with a modem that works, until the message reaches the gateway."""
    device = SimulatedSbdModem()
    modem.send(MESSAGE, now)
    for _ in range(MAX_STEPS):
        while sent := modem.data_to_send():
            device.receive(sent, now)
            modem.receive(device.output(), now)
        if any(MESSAGE in message for message in device.sent):
            return
        times = [due for due in (modem.next_timeout(), device.next_timeout()) if due is not None]
        now = max(now, min(times, default=now))
        modem.handle_timeout(now)
        device.advance(now)
        modem.receive(device.output(), now)
    raise RuntimeError("the session does not recover")


def check(data: bytes) -> None:
    """Feed the bytes to everything that takes bytes of a modem, a program or the gateway."""
    stream = b"".join(FRAGMENTS[byte] if byte < len(FRAGMENTS) else bytes([byte]) for byte in data)
    modem = SbdModem(0.0, interval=10.0, poll=float(len(data) % 3 * 60))
    modem.send(data[:MAX_SENT] or b"first", 0.0)
    recover(modem, converse(modem, stream))
    device = SimulatedSbdModem()
    device.receive(stream, 0.0)
    device.advance(100.0)
    device.output()
    hook = parse_hook(data)
    if hook is not None and len(hook.data) > MAX_SENT:
        raise RuntimeError("a web hook delivers more than a message")
    failure_of(data)


if __name__ == "__main__":
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()
