"""A WebSocket client that costs little, for the benchmark."""

from __future__ import annotations

import socket

HOST = "127.0.0.1"
#: The opcodes of messages.
TEXT, BINARY = 1, 2
_OPCODE, _FINAL, _MASKED = 0x0F, 0x80, 0x80
#: The mask of the messages of this client.
_MASK = bytes(4)
#: The shortest lengths of a message with a longer header.
_LENGTH_16, _LENGTH_64 = 126, 127


def handshake(port: int, path: str, subprotocol: str) -> bytes:
    """Return the request of a WebSocket; it offers compression, as browsers do."""
    lines = [
        f"GET {path} HTTP/1.1",
        f"Host: {HOST}:{port}",
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits",
        *([f"Sec-WebSocket-Protocol: {subprotocol}"] if subprotocol else []),
    ]
    return "".join(f"{line}\r\n" for line in (*lines, "")).encode()


class WebSocket:
    """One client; a subclass takes the messages.

    Args:
        port: The port of the server.
        request: The request from `handshake`.
        buffer: The size of its receive buffer in bytes; None: the default of the system.
    """

    def __init__(self, port: int, request: bytes, *, buffer: int | None = None) -> None:
        self.sock = socket.socket()
        if buffer is not None:
            self.sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
        self.sock.connect((HOST, port))
        self.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.sock.sendall(request)
        answer = bytearray()
        while not answer.endswith(b"\r\n\r\n"):
            byte = self.sock.recv(1)
            if not byte:
                break
            answer += byte
        if b" 101 " not in answer:
            raise SystemExit(f"the handshake failed: {answer!r}")
        if b"permessage-deflate" in answer:
            raise SystemExit("the server compresses messages")
        self._rest = b""

    def read(self) -> None:
        """Take the messages that have arrived."""
        received = self.sock.recv(1 << 18)
        if not received:
            raise SystemExit("the server closed a WebSocket")
        data, position = self._rest + received, 0
        while position + 2 <= len(data):
            length, start = data[position + 1], position + 2
            if length >= _LENGTH_16:
                size = 2 if length == _LENGTH_16 else 8
                length, start = int.from_bytes(data[start : start + size]), start + size
            if len(data) < start + length or start > len(data):
                break
            self.take(data[position] & _OPCODE, data, start, start + length)
            position = start + length
        self._rest = data[position:]

    def take(self, opcode: int, data: bytes, start: int, end: int) -> None:
        """Take a message: a part of the data."""
        raise NotImplementedError

    def send(self, opcode: int, data: bytes) -> None:
        """Send a message."""
        length = len(data)
        if length < _LENGTH_16:
            head = bytes([_FINAL | opcode, _MASKED | length])
        else:
            head = bytes([_FINAL | opcode, _MASKED | _LENGTH_16]) + length.to_bytes(2)
        self.sock.sendall(head + _MASK + data)
