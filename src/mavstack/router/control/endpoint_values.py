"""An endpoint as the values of its table, which a request changes key by key."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mavstack.router.config import RouterConfig, toml_text

if TYPE_CHECKING:
    from mavstack.router.config import EndpointConfig


def values_of(endpoint: EndpointConfig) -> dict[str, Any]:
    """Return the keys and values that a configuration file would have for an endpoint."""
    text = toml_text(RouterConfig((replace(endpoint, name="x"),)))
    values: dict[str, Any] = tomllib.loads(text)["endpoint"]["x"]
    return values
