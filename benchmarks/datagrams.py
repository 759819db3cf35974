"""Datagrams that leave many per system call (`sendmmsg`), so that the sender is not the limit."""

from __future__ import annotations

import ctypes
import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import socket
    from collections.abc import Sequence

#: Datagrams of one system call.
BATCH = 32


class _Slice(ctypes.Structure):
    """`struct iovec`: bytes in memory."""

    _fields_ = (("base", ctypes.c_char_p), ("length", ctypes.c_size_t))


class _Header(ctypes.Structure):
    """`struct msghdr` of Linux: a datagram for a connected socket."""

    _fields_ = (
        ("name", ctypes.c_void_p),
        ("name_length", ctypes.c_uint32),
        ("slices", ctypes.POINTER(_Slice)),
        ("slice_count", ctypes.c_size_t),
        ("control", ctypes.c_void_p),
        ("control_length", ctypes.c_size_t),
        ("flags", ctypes.c_int),
    )


class _Entry(ctypes.Structure):
    """`struct mmsghdr` of Linux: a datagram, and the number of its bytes that were sent."""

    _fields_ = (("header", _Header), ("sent", ctypes.c_uint32))


class Batch:
    """Datagrams that are sent together, any number of times."""

    def __init__(self, datagrams: Sequence[bytes]) -> None:
        self._datagrams = tuple(datagrams)
        self._slices = [_Slice(data, len(data)) for data in self._datagrams]
        headers = (_Header(slices=ctypes.pointer(each), slice_count=1) for each in self._slices)
        self._entries = (_Entry * len(self._slices))(*map(_Entry, headers))
        self._send = getattr(ctypes.CDLL(None, use_errno=True), "sendmmsg", None)

    def __len__(self) -> int:
        return len(self._datagrams)

    def send(self, sock: socket.socket) -> None:
        """Send all of them on a connected socket that blocks."""
        if self._send is None:
            for data in self._datagrams:
                sock.send(data)
        elif self._send(sock.fileno(), self._entries, len(self), 0) != len(self):
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def batches(datagrams: Sequence[bytes]) -> list[Batch]:
    """Return batches of these datagrams, in order, without the rest that fills no batch."""
    starts = range(0, len(datagrams) - BATCH + 1, BATCH)
    return [Batch(datagrams[start : start + BATCH]) for start in starts]
