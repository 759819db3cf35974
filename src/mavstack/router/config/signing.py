"""The keys of an endpoint: the table `[endpoint.NAME.signing]`, or `signing_key` in its URL.

`mavstack.router.gateway` uses them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import LinkURLError, MissingExtraError, SigningError

if TYPE_CHECKING:
    from mavstack.links import Link
    from mavstack.router.config.names import Names
    from mavstack.router.config.tables import Table

#: Ids of the messages that are accepted unsigned: RADIO_STATUS, which radios send themselves, without a key.
UNSIGNED: Final = frozenset({109})


@dataclass(frozen=True, slots=True)
class SigningConfig:
    """The signing of one endpoint.

    Attributes:
        incoming: File or name of the key of packets from the endpoint; empty: signatures are not looked at.
        outgoing: File or name of the key of packets to the endpoint; empty: signatures are left as they are.
        allow_unsigned: Ids of the messages that are accepted unsigned.
        strip: Verified signatures are removed.
    """

    incoming: str = ""
    outgoing: str = ""
    allow_unsigned: frozenset[int] = UNSIGNED
    strip: bool = True


def read_signing(table: Table, names: Names) -> SigningConfig:
    """Read the table `[endpoint.NAME.signing]`; the keys must exist.

    Args:
        table: The table.
        names: Names of messages.

    Returns:
        The configuration.

    Raises:
        RouterConfigError: The table is not valid; the text has file and line.
    """
    config = SigningConfig(
        incoming=table.value("in", str, ""),
        outgoing=table.value("out", str, ""),
        allow_unsigned=frozenset(table.members("allow_unsigned", names.message)) or UNSIGNED,
        strip=table.value("strip", bool, default=True),
    )
    table.finish()
    for key, name in (("in", config.incoming), ("out", config.outgoing)):
        try:
            if name:
                _find_key(name)
        except (SigningError, MissingExtraError) as error:
            table.refuse(key, f"is no key: {error}")
    if not config.incoming and not config.outgoing:
        table.refuse("", "needs a key: in, out or both")
    return config


def check_link_settings(link: Link) -> None:
    """Check the options of a URL that say how to speak over the link: a router takes `signing_key` alone.

    Args:
        link: The link.

    Raises:
        LinkURLError: There is no such key, or an option is for programs that send packets of their own.
    """
    settings, shown = link.settings, link.url.redacted
    if own := [name for name in settings.given if name != "signing_key"]:
        raise LinkURLError(f"{shown}: a router sends no packets of its own: leave {own[0]} out")
    try:
        if settings.signing_key:
            _find_key(settings.signing_key)
    except (SigningError, MissingExtraError) as error:
        raise LinkURLError(f"{shown}: signing_key is no key: {error}") from None


def _find_key(name: str) -> None:
    from mavstack.security.key_store import find_key

    find_key(name)
