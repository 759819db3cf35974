"""The file transfer protocol: access to the files of a component (guide: MAVLink FTP)."""

from mavstack.services.ftp.client import FtpClient
from mavstack.services.ftp.directory_store import DirectoryStore
from mavstack.services.ftp.entries import Entry
from mavstack.services.ftp.operations import (
    ComputeChecksum,
    DownloadFile,
    EndSession,
    ListDirectory,
    PathOperation,
    UploadFile,
)
from mavstack.services.ftp.overlay import OverlayStore, VirtualFile
from mavstack.services.ftp.payload import FtpError, FtpPayload, Opcode, file_crc32
from mavstack.services.ftp.server import FtpServer
from mavstack.services.ftp.stores import FileStore, MemoryStore, OpenFile
from mavstack.services.ftp.uri import FtpLocation, parse_ftp_uri

__all__ = [
    "ComputeChecksum",
    "DirectoryStore",
    "DownloadFile",
    "EndSession",
    "Entry",
    "FileStore",
    "FtpClient",
    "FtpError",
    "FtpLocation",
    "FtpPayload",
    "FtpServer",
    "ListDirectory",
    "MemoryStore",
    "Opcode",
    "OpenFile",
    "OverlayStore",
    "PathOperation",
    "UploadFile",
    "VirtualFile",
    "file_crc32",
    "parse_ftp_uri",
]
