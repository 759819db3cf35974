"""Packets that are put together as one sample, so that a read of many packets costs one sample."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

#: Maximum size of a sample in bytes: it fits into one datagram on most networks.
MAX_BYTES: Final = 1400


def samples_of(packets: Sequence[bytes], limit: int = MAX_BYTES) -> Iterator[bytes]:
    """Yield the samples of packets: whole packets only, in their order.

    Args:
        packets: The packets of one vehicle.
        limit: Bytes of a sample; a larger packet is a separate sample.
    """
    data = b"".join(packets)
    if len(data) <= limit:  # almost always
        if data:
            yield data
        return
    begin = end = 0
    for packet in packets:
        if end > begin and end + len(packet) - begin > limit:
            yield data[begin:end]
            begin = end
        end += len(packet)
    yield data[begin:]
