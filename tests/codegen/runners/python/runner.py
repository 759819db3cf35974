"""The runner of generated Python packages: python runner.py PACKAGE; it runs on MicroPython too."""

import struct
import sys
from binascii import hexlify, unhexlify

FORMATS = {
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


def field_bytes(field, value):
    """Return the little-endian bytes of a value."""
    length = max(field.array_length, 1)
    if isinstance(value, str):
        value = value.encode()
    if isinstance(value, (bytes, bytearray)):
        return bytes(value) + bytes(length - len(value))
    values = value if isinstance(value, tuple) else (value,)
    return b"".join([struct.pack("<" + FORMATS[field.type], item) for item in values])


class Runner:
    """Parses inputs with a generated package."""

    def __init__(self, name):
        self.package = __import__(name)
        self.info = __import__(name + ".info").info

    def run(self, line):
        """Parse one input, in pieces of growing size."""
        name, key, now, data = line.split()
        key = None if key == "-" else unhexlify(key)
        data = unhexlify(data)
        signing = None if key is None else self.package.Signing(key, 0, 0 if now == "-" else int(now))
        parser = self.package.Parser(signing)
        size = start = 0
        while start < len(data):
            size = size % 97 + 1
            for packet in parser.feed(data[start : start + size]):
                self.show(packet, key)
            start += size
        counters = ("good", "bad_crc", "bad_signature", "unknown")
        print("end " + name, " ".join([item + "=" + str(getattr(parser, item)) for item in counters]))

    def show(self, packet, key):
        """Print a packet and the same message packed again."""
        message = packet.message
        words = ["packet", packet.name, packet.message_id, packet.version, packet.sequence]
        words += [packet.system, packet.component, int(packet.signed)]
        for field, name in zip(self.info.FIELDS[packet.message_id], message.__slots__):  # noqa: B905 (MicroPython has no strict)
            words.append(field.name + "=" + hexlify(field_bytes(field, getattr(message, name))).decode())
        print(" ".join([str(word) for word in words]))
        signing = None
        if packet.signed and key:
            signing = self.package.Signing(key, packet.link_id, packet.timestamp - 1)
        data = message.pack(packet.system, packet.component, packet.sequence, packet.version, signing)
        print("packed", packet.name, hexlify(data).decode())


if __name__ == "__main__":
    runner = Runner(sys.argv[1])
    for line in sys.stdin:
        runner.run(line)
