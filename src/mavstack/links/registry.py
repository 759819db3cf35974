"""Links by their URLs; the backend of a scheme is a module that is imported on first use.

The schemes are in `scheme_table`: those of Mavstack, and those that other packages add.
"""

from __future__ import annotations

from importlib import import_module
from os.path import isfile
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.errors import InvalidArgumentError, LinkURLError
from mavstack.links.impairment import Impairment
from mavstack.links.options import Options
from mavstack.links.scheme_table import SCHEMES, builtin_schemes
from mavstack.links.schemes.sealed import SEALED
from mavstack.links.url import LinkURL, parse_url, redact_options

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.base import Link
    from mavstack.links.scheme import LinkScheme

#: The values of the URL option `radio`; the first is the default.
RADIOS: Final = ("none", "sik")

Backend: TypeAlias = "Callable[[LinkURL, Options], Link]"


def open_link(url: str | LinkURL, **options: object) -> Link:
    """Create the link of a URL; `async with` or `await` opens it.

    Args:
        url: A link URL such as `udpin://0.0.0.0:14550`, a serial device, or the path of a file to replay.
        options: Options in addition to those of the URL, such as `reconnect=False`.

    Returns:
        The link, not open yet.

    Raises:
        LinkURLError: The URL is malformed, or an option is unknown or malformed.
        LinkError: A certificate cannot be read.
        MissingExtraError: The scheme needs an optional dependency.
    """
    parsed = (resolve_url(url) if isinstance(url, str) else url).with_options(**options)
    reader = Options(parsed)
    is_sealed = parsed.scheme.startswith(SEALED)  # a sealed link applies the impairment to its inner link
    link = _backend(parsed.scheme)(parsed, reader) if is_sealed else impaired_link(parsed, reader)
    reader.refuse_unknown()
    return link


def impaired_link(url: LinkURL, options: Options) -> Link:
    """Create the link of a URL with the impairments of its options."""
    impairment = Impairment.from_options(options)
    radio = options.choice("radio", RADIOS)
    link = _backend(url.scheme)(url, options)
    if radio == "sik":
        from mavstack.links.radio import sik_radio

        return sik_radio(link, impairment)
    if impairment is None:
        return link
    from mavstack.links.impaired import impair

    return impair(link, impairment)


def plain_link(url: LinkURL, options: Options) -> Link:
    """Create the link of a URL without the impairments of its options, for a link that is built upon it."""
    return _backend(url.scheme)(url, options)


def resolve_url(text: str) -> LinkURL:
    """Parse a URL, or the path of an existing file without a scheme; raises `LinkURLError`."""
    is_file = "://" not in text and isfile(text)  # noqa: PTH113 - unlike Path.is_file, it never raises
    return LinkURL("file", path=text) if is_file else parse_url(text, _plugin_schemes(text))


def _plugin_schemes(text: str) -> dict[str, LinkScheme]:
    """Return the record of the scheme of a URL that another package adds."""
    scheme, separator, _ = text.strip().partition("://")
    scheme = scheme.lower()
    if not separator or scheme in builtin_schemes() or scheme not in SCHEMES.plugins().names:
        return {}
    try:
        return {scheme: SCHEMES.get(scheme)}
    except InvalidArgumentError as error:
        raise LinkURLError(f"invalid link URL {redact_options(text)!r}: {error}") from error


def _backend(scheme: str) -> Backend:
    module, name = SCHEMES.get(scheme).backend.split(":")
    backend: Backend = getattr(import_module(module), name)
    return backend
