"""File formats that are not streams of MAVLink packets, recognised by their first bytes."""

from __future__ import annotations

from typing import Final

#: First bytes of each other format, its name, and the program that reads or converts it.
_OTHER_FORMATS: Final = (
    (b"ULog\x01\x12\x35", "a PX4 ULog (mavstack.open_log reads it)"),
    (b"\xa3\x95\x80", "an ArduPilot dataflash log (mavstack.open_log reads it)"),
    (b"FMT, 128, ", "an ArduPilot dataflash log as text (mavstack.open_log reads it)"),
    (b"\x89MCAP0\r\n", "an MCAP recording"),
    (b"#ROSBAG V", "a ROS bag"),
    (b"\x0a\x0d\x0d\x0a", "a pcapng capture"),
    (b"\xd4\xc3\xb2\xa1", "a pcap capture"),
    (b"\xa1\xb2\xc3\xd4", "a pcap capture"),
    (b"\x1f\x8b\x08", "a gzip archive: unpack it first"),
    (b"PK\x03\x04", "a ZIP archive: unpack it first"),
    (b"BZh", "a bzip2 archive: unpack it first"),
    (b"\xfd7zXZ\x00", "an xz archive: unpack it first"),
    (b"\x28\xb5\x2f\xfd", "a Zstandard archive: unpack it first"),
)
#: Number of first bytes of a file that are enough to recognise each format.
MAX_MAGIC_LENGTH: Final = max(len(magic) for magic, _ in _OTHER_FORMATS)


def other_format(head: bytes) -> str | None:
    """Return the name of another format, or None if the bytes may begin a stream of packets.

    Args:
        head: The first bytes of the file.
    """
    return next((name for magic, name in _OTHER_FORMATS if head.startswith(magic)), None)
