"""The parameter protocol: client and server, in both encodings (guide: parameter protocol)."""

from mavstack.services.parameters.cache import Snapshot
from mavstack.services.parameters.client import ParameterChanged, ParameterClient, ParameterRounded
from mavstack.services.parameters.hashing import HASH_NAME, hash_of
from mavstack.services.parameters.metadata import MetadataTable, ParameterMetadata
from mavstack.services.parameters.operations import DownloadParameters, GetParameter, ReadHash, SetParameter
from mavstack.services.parameters.packed import PACKED_NAME, PackedFile, unpack, write, write_upload
from mavstack.services.parameters.renamed import RENAMED, RenamedParameter, renaming_of
from mavstack.services.parameters.server import ParameterServer, ParameterWritten
from mavstack.services.parameters.table import ParameterDefinition, ParameterTable
from mavstack.services.parameters.value import Encoding, Parameter, Value, encoding_of

__all__ = [
    "HASH_NAME",
    "PACKED_NAME",
    "RENAMED",
    "DownloadParameters",
    "Encoding",
    "GetParameter",
    "MetadataTable",
    "PackedFile",
    "Parameter",
    "ParameterChanged",
    "ParameterClient",
    "ParameterDefinition",
    "ParameterMetadata",
    "ParameterRounded",
    "ParameterServer",
    "ParameterTable",
    "ParameterWritten",
    "ReadHash",
    "RenamedParameter",
    "SetParameter",
    "Snapshot",
    "Value",
    "encoding_of",
    "hash_of",
    "renaming_of",
    "unpack",
    "write",
    "write_upload",
]
