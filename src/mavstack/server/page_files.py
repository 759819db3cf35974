"""The files of the pages, which the build compresses: the station sends them as they are.

To compress them for each client would hold up the packets of all others; uncompressed, the first view is four
times as large. Names of files in `assets/` change with their content, so that browsers may keep them.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Final

from starlette.datastructures import Headers
from starlette.staticfiles import StaticFiles

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from starlette.responses import Response
    from starlette.types import Scope

ENCODING: Final = "gzip"
KEPT: Final = "assets"
KEEPING: Final = "public, max-age=31536000, immutable"
_REFUSED: Final = re.compile(r"\s*q\s*=\s*0(?:\.0*)?\s*", re.IGNORECASE)


class PageFiles(StaticFiles):
    """Files of a folder, with headers of their own.

    Answers without content (304) have the headers too, since they replace those in the cache of a browser.
    """

    def __init__(self, folder: Path, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(directory=folder, check_dir=False)
        self._headers = dict(headers or {})

    def file_response(
        self,
        full_path: str | os.PathLike[str],
        stat_result: os.stat_result,
        scope: Scope,
        status_code: int = 200,
    ) -> Response:
        """Return a file, compressed if it is there so and the client takes it."""
        compressed = Path(f"{full_path}.gz")
        is_compressed = _takes_gzip(scope) and compressed.is_file()
        path = compressed if is_compressed else full_path
        found = compressed.stat() if is_compressed else stat_result
        response = super().file_response(path, found, scope, status_code)
        if is_compressed:
            response.headers["Content-Encoding"] = ENCODING
        response.headers["Vary"] = "Accept-Encoding"
        if Path(full_path).parent.name == KEPT:
            response.headers["Cache-Control"] = KEEPING
        response.headers.update(self._headers)
        return response


def _takes_gzip(scope: Scope) -> bool:
    """Return whether a client takes the encoding; `q=0` refuses it."""
    for each in Headers(scope=scope).get("accept-encoding", "").split(","):
        name, _, weight = each.partition(";")
        if name.strip() in (ENCODING, "*"):
            return _REFUSED.fullmatch(weight) is None
    return False
