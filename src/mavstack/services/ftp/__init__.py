"""The file transfer protocol: files of a component, read and changed by others (guide: MAVLink FTP)."""

from mavstack.services.ftp.client import (
    ChecksumOperation,
    EndSession,
    FtpClient,
    ListOperation,
    PathOperation,
    ReadOperation,
    WriteOperation,
)
from mavstack.services.ftp.entries import Entry
from mavstack.services.ftp.overlay import OverlayStore, VirtualFile
from mavstack.services.ftp.payload import FtpError, FtpPayload, Opcode, file_crc32
from mavstack.services.ftp.server import FtpServer
from mavstack.services.ftp.stores import DirectoryStore, FileStore, MemoryStore, OpenFile

__all__ = [
    "ChecksumOperation",
    "DirectoryStore",
    "EndSession",
    "Entry",
    "FileStore",
    "FtpClient",
    "FtpError",
    "FtpPayload",
    "FtpServer",
    "ListOperation",
    "MemoryStore",
    "Opcode",
    "OpenFile",
    "OverlayStore",
    "PathOperation",
    "ReadOperation",
    "VirtualFile",
    "WriteOperation",
    "file_crc32",
]
