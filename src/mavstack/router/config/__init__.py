"""The configuration of a router: a TOML file, checked key by key, with file and line in each error."""

from __future__ import annotations

from mavstack.router.config.model import EndpointConfig, PacketFilter, Recording, RouterConfig
from mavstack.router.config.reading import check_control, endpoint_from_values, load_config, parse_config
from mavstack.router.config.signing import SigningConfig, check_link_settings
from mavstack.router.config.tables import Table
from mavstack.router.config.toml_text import toml_text

__all__ = [
    "EndpointConfig",
    "PacketFilter",
    "Recording",
    "RouterConfig",
    "SigningConfig",
    "Table",
    "check_control",
    "check_link_settings",
    "endpoint_from_values",
    "load_config",
    "parse_config",
    "toml_text",
]
