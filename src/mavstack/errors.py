"""The one exception tree: everything Mavstack raises on purpose derives from `MavstackError`.

Bad input from the wire never raises (it is counted); what raises is a definition that is wrong, a link
that cannot be opened, or a misuse by the calling program. Misuse also derives from the built-in that a
Python user would expect (`TypeError`, `ValueError`, `KeyError`), so that both `except` clauses work.
"""

from __future__ import annotations


class MavstackError(Exception):
    """Base of every error that Mavstack raises on purpose."""


class LocalProtocolError(MavstackError):
    """The calling program asked for something the protocol does not allow."""


class FieldNameError(LocalProtocolError, TypeError):
    """A message was given a field that its definition does not have."""


class FieldTypeError(LocalProtocolError, TypeError):
    """A message field was given a value of a kind that it cannot hold."""


class FieldRangeError(LocalProtocolError, ValueError):
    """A message field was given a value outside the range of its type; the text names the range."""


class EncodeError(LocalProtocolError, ValueError):
    """A message cannot be sent as asked, such as an id over 255 in MAVLink 1."""


class SigningError(LocalProtocolError, ValueError):
    """A signing key, link id or timestamp is not usable; the text never holds the key."""


class DialectError(MavstackError):
    """A definition file is missing, broken or contradicts itself; `path` and `line` say where."""

    def __init__(self, problem: str, path: str | None = None, line: int | None = None) -> None:
        self.problem = problem
        self.path = path
        self.line = line
        where = "" if path is None else f"{path}:{line}: " if line is not None else f"{path}: "
        super().__init__(where + problem)

    def __reduce__(self) -> tuple[type[DialectError], tuple[str, str | None, int | None]]:
        return type(self), (self.problem, self.path, self.line)


class UnknownMessageError(MavstackError, KeyError):
    """A dialect has no message of that name or id."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class UnknownDialectError(DialectError, KeyError):
    """No official dialect has that name."""

    def __str__(self) -> str:
        return Exception.__str__(self)


class LogError(MavstackError):
    """A log file cannot be read at all; damage inside a log is counted, never raised."""


class LinkError(MavstackError):
    """A link cannot be opened or used; the text names the URL and what to do."""


class LinkURLError(LinkError, ValueError):
    """A link URL cannot be understood."""


class LinkClosedError(LinkError):
    """The link or channel is closed."""


class MissingExtraError(MavstackError, ImportError):
    """A feature needs an optional dependency; the text holds the line that installs it."""

    def __init__(self, feature: str, extra: str) -> None:
        self.feature = feature
        self.extra = extra
        super().__init__(f"{feature} needs an extra: pip install 'mavstack[{extra}]'")

    def __reduce__(self) -> tuple[type[MissingExtraError], tuple[str, str]]:
        return type(self), (self.feature, self.extra)
