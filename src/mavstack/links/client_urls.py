"""The URLs that a client without a password may open on a server: every program of the machine is a client.

Neither files nor sockets of the file system are opened for such a client, since they belong to the user of
the server alone; nor may an option name a file, since the answer would show whether it exists.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.links.scheme_table import find_scheme

if TYPE_CHECKING:
    from mavstack.links.url import LinkURL

#: Options that name a key, by its name or by the path of its file.
KEY_OPTIONS: Final = frozenset({"signing_key", "ticket_key", "shared_key", "private_key", "peer"})
#: Options with a file name, and `gateway`, a server that this machine would connect to.
_FILE_OPTIONS: Final = frozenset({"account", "ca", "cert", "gateway", "key", "roles"})


def is_network_scheme(name: str) -> bool:
    """Return whether links of a scheme reach their peers over a network."""
    scheme = find_scheme(name)
    return scheme is not None and scheme.is_network


def is_network_or_device_scheme(name: str) -> bool:
    """Return whether links of a scheme reach their peers over a network or a serial port."""
    scheme = find_scheme(name)
    return scheme is not None and (scheme.is_network or scheme.is_device)


def options_with_paths(url: LinkURL) -> list[str]:
    """Return the names of the options of a URL that name a file, sorted."""
    return sorted(
        name
        for name, value in url.options.items()
        if name in _FILE_OPTIONS or (name in KEY_OPTIONS and not _is_plain(value))
    )


def _is_plain(value: str) -> bool:
    """Return whether a value is the name of a key, or a public key: no path."""
    return value.replace("-", "").replace("_", "").isalnum()
