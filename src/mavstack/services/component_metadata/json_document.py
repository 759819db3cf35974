"""JSON documents from outside, within bounds on size, depth and number of values."""

from __future__ import annotations

import json
from typing import Any, Final

from mavstack.errors import MetadataError
from mavstack.services.component_metadata.contents import MAX_CONTENT

#: The largest numbers of objects and arrays, and of all values, in a document: a parsed value needs up to a
#: hundred times the memory of its text. The largest published files have 30,000 objects and arrays, and
#: 150,000 values.
MAX_CONTAINERS: Final = 300_000
MAX_VALUES: Final = 2_000_000


def parse_json(data: bytes) -> dict[str, Any]:
    """Parse a document whose root is an object.

    Args:
        data: UTF-8 text.

    Returns:
        The object.

    Raises:
        MetadataError: The text is not JSON, its root is not an object, or it is too large or too deep.
    """
    if len(data) > MAX_CONTENT:
        raise MetadataError(f"the JSON has {len(data)} bytes, more than any metadata")
    containers = data.count(b"{") + data.count(b"[")
    if containers > MAX_CONTAINERS or containers + data.count(b",") > MAX_VALUES:
        raise MetadataError("the JSON holds more values than any metadata")
    try:
        found = json.loads(data.decode("utf-8-sig"))
    except RecursionError:
        raise MetadataError("the JSON is nested too deeply") from None
    except json.JSONDecodeError as error:
        raise MetadataError(f"not JSON: {error.msg}", line=error.lineno) from None
    except UnicodeDecodeError:
        raise MetadataError("not UTF-8 text") from None
    except ValueError:  # a number with thousands of digits
        raise MetadataError("the JSON holds a number that is too long") from None
    if not isinstance(found, dict):
        raise MetadataError("the root of the JSON is not an object")
    return found
