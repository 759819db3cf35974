"""Metadata of parameters from the files that firmware projects publish, and the cache of downloaded files."""

from mavstack.files.parameter_metadata.cache import MetadataCache
from mavstack.files.parameter_metadata.file_access import (
    parse_parameter_metadata,
    read_metadata_file,
    read_parameter_metadata,
)
from mavstack.user_directories import cache_directory

__all__ = [
    "MetadataCache",
    "cache_directory",
    "parse_parameter_metadata",
    "read_metadata_file",
    "read_parameter_metadata",
]
