"""Component metadata: files that describe a component (guide: component metadata protocol).

    COMPONENT_METADATA ──► general file ──► one file per type: parameters, events, actuators …
    (uri, CRC)             (JSON)           (JSON)

The message names the general file by a URI, which MAVLink FTP serves (`mftp://etc/extras/general.json.xz`),
and the general file names the others, which may also lie on a web server. The older COMPONENT_INFORMATION
names a general file too. Files may be compressed (xz). A CRC-32 tells a ground station whether it has a file
already; components compute it over the file as it is served or over its uncompressed content (PX4 does the
latter for the general file alone), so both are accepted. A file may have translations (`translation.py`).

The files come from outside: sizes are checked before and while they are decompressed, and every problem is a
`MetadataError`.
"""

from mavstack.services.component_metadata.contents import MAX_CONTENT, MAX_FILE, has_crc, unpack_content
from mavstack.services.component_metadata.general import MetadataFile, parse_general
from mavstack.services.component_metadata.json_document import parse_json
from mavstack.services.component_metadata.served import (
    GENERAL_NAME,
    ServedMetadata,
    provide_component_metadata,
    summary_name,
    translation_name,
)
from mavstack.services.component_metadata.translation import (
    PARAMETER_RULES,
    find_locale,
    parse_translations,
    translate_content,
)
from mavstack.services.component_metadata.uri import parse_uri

__all__ = [
    "GENERAL_NAME",
    "MAX_CONTENT",
    "MAX_FILE",
    "PARAMETER_RULES",
    "MetadataFile",
    "ServedMetadata",
    "find_locale",
    "has_crc",
    "parse_general",
    "parse_json",
    "parse_translations",
    "parse_uri",
    "provide_component_metadata",
    "summary_name",
    "translate_content",
    "translation_name",
    "unpack_content",
]
