"""ROS 2 interfaces as data: definitions, type hashes, CDR, texts of schemas."""

from mavstack.bridges.core.types.cdr import Codec, codec_of
from mavstack.bridges.core.types.definitions import definition_of, interface_names
from mavstack.bridges.core.types.hashes import type_hash
from mavstack.bridges.core.types.model import Constant, Definition, Field, FieldType
from mavstack.bridges.core.types.schemas import json_schema, message_text

__all__ = [
    "Codec",
    "Constant",
    "Definition",
    "Field",
    "FieldType",
    "codec_of",
    "definition_of",
    "interface_names",
    "json_schema",
    "message_text",
    "type_hash",
]
