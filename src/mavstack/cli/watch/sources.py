"""The sources that are watched together: each link or file has an observer, and several have a letter each.

One picture shows them all. A vehicle that is heard on two links has a row for each, so that the links can be
compared; the letter of the source is before its system and component.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from string import ascii_uppercase
from time import monotonic
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.errors import UsageError
from mavstack.cli.watch.link_follower import Follower
from mavstack.cli.watch.observer import Observer
from mavstack.cli.watch.recording import STDIN
from mavstack.cli.watch.snapshot import merge_snapshots, take_snapshot
from mavstack.cli.watch.summary import merge_summaries, summary_object
from mavstack.errors import LinkURLError, LogError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.cli.watch.observer import Selection
    from mavstack.cli.watch.snapshot import Snapshot
    from mavstack.dialects import Dialect

MAX_SOURCES: Final = len(ascii_uppercase)


@dataclass(eq=False, slots=True)
class WatchedSource:
    """A link or file: its text on the command line, its letter if there are several, its observer."""

    text: str
    label: str
    observer: Observer
    follower: Follower
    #: The URL or path without passwords and tokens.
    title: str
    #: The path of a file to read; None for a link to follow.
    path: str | None = None

    @property
    def seconds(self) -> float | None:
        """Seconds of the observation; None if they are not known."""
        followed = self.path is None
        return self.follower.seconds if followed else self.observer.recorded_seconds

    @property
    def is_live(self) -> bool:
        """False for a recording, read or replayed."""
        return recording_path(self.text) is None and not self.text.startswith("file:")


def open_sources(
    texts: Sequence[str], dialect: Dialect, selection: Selection, observer_class: type[Observer] = Observer
) -> list[WatchedSource]:
    """Return the sources of the command line; raises UsageError if there are too many."""
    if len(texts) > MAX_SOURCES:
        raise UsageError(f"at most {MAX_SOURCES} sources can be given together, got {len(texts)}")
    sources = []
    for letter, text in zip(ascii_uppercase, texts, strict=False):
        observer = observer_class(dialect, selection)
        path = recording_path(text)
        title = text if path is not None else _redacted(text)
        label = letter if len(texts) > 1 else ""
        sources.append(WatchedSource(text, label, observer, Follower(observer), title, path))
    return sources


def recording_path(source: str) -> str | None:
    """Return the path of a source that is a file to read; None for a link to follow."""
    if source == STDIN or Path(source).is_file():
        return source
    from mavstack.links import parse_url

    try:
        url = parse_url(source)
    except LinkURLError:
        if "://" not in source and Path(source).exists():
            raise LogError(f"{source}: it is not a file") from None
        return None
    return url.path if url.scheme == "file" and not url.options else None


def take_picture(sources: Sequence[WatchedSource]) -> Snapshot:
    """Return a snapshot of one source, or of several together."""
    return merge_snapshots(take_snapshots(sources, monotonic()))


def take_snapshots(sources: Sequence[WatchedSource], now: float) -> dict[str, Snapshot]:
    """Return a snapshot of each source by its letter; `now` is the time on a monotonic clock."""
    return {
        source.label: take_snapshot(
            source.observer, source.title, now, source.seconds, source.follower.note, source.follower.refused
        )
        for source in sources
    }


def take_summary(sources: Sequence[WatchedSource]) -> dict[str, Any]:
    """Return the counts of one source, or of several together, as values for JSON."""
    parts = [summary_object(each.observer, each.seconds, each.follower.refused) for each in sources]
    return merge_summaries([source.title for source in sources], parts)


def _redacted(text: str) -> str:
    from mavstack.links.url import redact_options

    return redact_options(text)
