"""Dialects: MAVLink definitions, and the typed message and enum classes made from them.

Each official dialect is a module of this package: `from mavstack.dialects import common`.
"""

from __future__ import annotations

from mavstack.dialects.dialect import Dialect as Dialect
from mavstack.dialects.message import Message as Message
