"""Fuzz target of MSP: any bytes are parsed alike in any chunks, and raise no unexpected error.

Run by `rust/fuzz/run`; needs `pip install atheris`.
"""

import sys

import atheris

with atheris.instrument_imports(include=["mavstack.msp"]):
    from mavstack.errors import InvalidArgumentError, MavstackError, MspDecodeError
    from mavstack.msp import Direction, FirmwareInfo, Frame, FrameParser, RequestEngine
    from mavstack.msp.cli import CliDialog, errors_in, restore_lines
    from mavstack.msp.messages import MspMessage
    from mavstack.msp.messages.identification import IDENTIFICATION
    from mavstack.msp.messages.registry import all_messages
    from mavstack.msp.parser import State

FIRMWARES = (
    None,
    FirmwareInfo("BTFL", (4, 5, 1), (1, 46)),
    FirmwareInfo("BTFL", (26, 12, 0), (1, 49)),
    FirmwareInfo("INAV", (8, 0, 0), (2, 5)),
)
MESSAGES = (*IDENTIFICATION, *all_messages())
#: A byte below their number stands for one of them.
FRAGMENTS = [
    b"$M>",
    b"$X>\x00",
    b"$M!\x00\x01\x01",
    b"$M>\xff\xff",
    b"$M>\xff\x01\x00\x10",
    Frame(108, bytes(6), Direction.RESPONSE).encode(),
    b"\r\n# ",
    b"# end 1",
    b"###ERROR IN set",
]


def parse(data: bytes) -> list[Frame]:
    """Parse in two ways, and compare the results."""
    whole, cut = FrameParser(), FrameParser()
    frames = whole.feed(data)
    parsed = [frame for at in range(0, len(data), 3) for frame in cut.feed(data[at : at + 3])]
    if parsed != frames or cut.take_text() != whole.take_text() or cut.state is not whole.state:
        raise RuntimeError("the result depends on the chunks")
    rest = whole.resynchronize()
    if whole.state is not State.IDLE:
        raise RuntimeError("the parser waits after resynchronize")
    for frame in frames + rest:
        if FrameParser().feed(frame.encode()) != [frame]:
            raise RuntimeError("a frame is not parsed as it was encoded")
    return frames + rest


def decode(kind: type[MspMessage], payload: bytes) -> None:
    """Decode a payload as a message of each firmware."""
    for firmware in FIRMWARES:
        try:
            kind.decode(payload, firmware).encode(firmware)
        except (MspDecodeError, InvalidArgumentError):
            continue


def request(data: bytes) -> None:
    """Send a request to a line that replies with the bytes: it ends."""
    engine = RequestEngine()
    sent = engine.request(data[0] if data else 1)
    now = 0.0
    for at in range(100):
        engine.receive(data[at * 5 : at * 5 + 5], now)
        engine.data_to_send()
        due = engine.next_due()
        if due is None:
            break
        now = max(now, due) if at % 3 == 0 else now
    if not sent.done:
        raise RuntimeError("the request does not end")


def converse(data: bytes) -> None:
    """Feed the bytes to everything that takes bytes of a flight controller."""
    stream = b"".join(FRAGMENTS[byte] if byte < len(FRAGMENTS) else bytes([byte]) for byte in data)
    for frame in parse(stream):
        for kind in MESSAGES:
            if frame.command == kind.COMMAND:
                decode(kind, frame.payload)
    if len(data) > 1:
        decode(MESSAGES[(data[0] | data[1] << 8) % len(MESSAGES)], data[2:])
    request(stream)
    dialog = CliDialog()
    dialog.send("get a")
    dialog.receive(stream)
    errors_in(dialog.reply() or "")
    try:
        restore_lines(stream.decode("latin-1"))
    except MavstackError:
        return


if __name__ == "__main__":
    atheris.Setup(sys.argv, converse)
    atheris.Fuzz()
