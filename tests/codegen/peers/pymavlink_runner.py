"""The conformance runner of pymavlink: python pymavlink_runner.py MODULE.py, a module that mavgen wrote."""

from __future__ import annotations

import struct
import sys
from importlib.util import module_from_spec, spec_from_file_location
from typing import Any

FORMATS = {
    "char": "c",
    "int8_t": "b",
    "uint8_t": "B",
    "int16_t": "h",
    "uint16_t": "H",
    "int32_t": "i",
    "uint32_t": "I",
    "int64_t": "q",
    "uint64_t": "Q",
    "float": "f",
    "double": "d",
}


def load(path: str) -> Any:
    spec = spec_from_file_location("mavlink", path)
    module = module_from_spec(spec)
    sys.modules["mavlink"] = module
    spec.loader.exec_module(module)
    return module


def field_bytes(kind: str, length: int, value: Any) -> bytes:
    if kind == "char":
        data = value if isinstance(value, bytes) else value.encode()
        return data.ljust(max(length, 1), b"\0")
    values = value if isinstance(value, (list, tuple, bytes, bytearray)) else [value]
    return b"".join(struct.pack("<" + FORMATS[kind], item) for item in values)


def connection(module: Any, system: int, component: int, key: str, timestamp: int) -> Any:
    mav = module.MAVLink(None, system, component)
    mav.robust_parsing = True
    if key != "-":
        mav.signing.secret_key = bytes.fromhex(key)
        mav.signing.timestamp = timestamp
    return mav


def show(module: Any, message: Any, key: str) -> None:
    header = message.get_header()
    data = bytes(message.get_msgbuf())
    version = 2 if data[0] == 0xFD else 1
    lengths = dict(zip(message.ordered_fieldnames, message.array_lengths, strict=True))
    fields = [
        f"{name}={field_bytes(kind, lengths[name], getattr(message, name)).hex()}"
        for name, kind in zip(message.fieldnames, message.fieldtypes, strict=True)
    ]
    signed = bool(version == 2 and data[2] & 1)
    words = [
        message.get_type(),
        message.get_msgId(),
        version,
        header.seq,
        header.srcSystem,
        header.srcComponent,
    ]
    print("packet", *words, int(signed), *fields)
    sender = connection(module, header.srcSystem, header.srcComponent, "-", 0)
    sender.seq = header.seq
    if signed and key != "-":
        sender = connection(
            module, header.srcSystem, header.srcComponent, key, int.from_bytes(data[-12:-6], "little")
        )
        sender.seq = header.seq
        sender.signing.link_id, sender.signing.sign_outgoing = data[-13], True
    print("packed", message.get_type(), message.pack(sender, force_mavlink1=version == 1).hex())


def run(module: Any, line: str) -> None:
    name, key, now, data = line.split()
    mav = connection(module, 255, 190, key, 0 if now == "-" else int(now))
    for message in mav.parse_buffer(bytes.fromhex(data)) or ():
        if message.get_msgId() >= 0:
            show(module, message, key)
    print(f"end {name}")


if __name__ == "__main__":
    library = load(sys.argv[1])
    for text in sys.stdin:
        run(library, text)
