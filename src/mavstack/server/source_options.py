"""The options of URLs that name files or keys, on a station whose clients need no password.

Every program of the machine, in a sandbox or of another user, may send requests there. Whether a file exists
must not be seen from the answers: paths are refused before the file system is asked, and a key that cannot be
used has one text, whatever the reason is.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from mavstack.errors import LinkError, SigningError
from mavstack.http.bodies import RefusedError
from mavstack.links.client_urls import KEY_OPTIONS, options_with_paths

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.links.url import LinkURL


def refuse_paths(url: LinkURL) -> None:
    """Refuse a URL with an option that names a file; raises `RefusedError`."""
    named = options_with_paths(url)
    if named:
        raise RefusedError(
            403, f"without a password no file can be named: leave out {', '.join(named)}, or set a password"
        )


@contextmanager
def same_error_for_keys(url: LinkURL) -> Iterator[None]:
    """Give errors about the keys of a URL one text; raises `RefusedError` for them."""
    named = sorted(KEY_OPTIONS & url.options.keys())
    try:
        yield
    except SigningError:
        _refuse(named)
    except LinkError as error:
        if named and isinstance(error.__context__, SigningError):
            _refuse(named)
        raise


def _refuse(named: list[str]) -> None:
    raise RefusedError(409, f"the link cannot be opened: {', '.join(named)} cannot be used") from None
