"""The requests of the control API: an endpoint with the keys of its table in a configuration.

The configuration itself judges the values (`mavstack.router.config`), so that both give the same errors.
"""

from __future__ import annotations

from typing import Annotated, Any, TypeAlias

from msgspec import UNSET, Meta, UnsetType

from mavstack.http.request_fields import Fields

Names: TypeAlias = list[int | str] | UnsetType
Limit: TypeAlias = float | str | UnsetType


class PacketFilterKeys(Fields):
    """A filter: what passes, and what does not."""

    allow_messages: Names = UNSET
    deny_messages: Names = UNSET
    allow_systems: Names = UNSET
    deny_systems: Names = UNSET
    allow_components: Names = UNSET
    deny_components: Names = UNSET
    allow_commands: Names = UNSET
    deny_commands: Names = UNSET


class ChangeEndpoint(Fields, kw_only=True, rename={"incoming": "in", "outgoing": "out"}):
    """Change keys of an endpoint."""

    url: Annotated[str, Meta(description="The link.", examples=["udpin://0.0.0.0:14550"])] | UnsetType = UNSET
    record: Annotated[str, Meta(description="The file of a recorder.")] | UnsetType = UNSET
    max_size: Limit = UNSET
    max_time: Limit = UNSET
    keep: int | UnsetType = UNSET
    group: Annotated[str, Meta(description="The group of redundant links.")] | UnsetType = UNSET
    listen_only: bool | UnsetType = UNSET
    pause: bool | UnsetType = UNSET
    rate: Annotated[float | str, Meta(description="Bytes per second, such as '20 kB/s'.")] | UnsetType = UNSET
    rates: (
        Annotated[dict[str, float | str], Meta(description="Hertz by message, such as '2 Hz'.")] | UnsetType
    ) = UNSET
    incoming: PacketFilterKeys | UnsetType = UNSET
    outgoing: PacketFilterKeys | UnsetType = UNSET
    high_latency: bool | float | str | UnsetType = UNSET
    signing: Annotated[dict[str, Any], Meta(description="Its keys.")] | UnsetType = UNSET


class AddEndpoint(ChangeEndpoint):
    """Add an endpoint."""

    name: Annotated[str, Meta(description="Letters, digits, '_', '-' and '.'.", examples=["tablet"])]
