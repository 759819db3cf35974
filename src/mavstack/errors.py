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


class InvalidArgumentError(LocalProtocolError, ValueError):
    """A call was given an argument outside what it accepts; the text names the argument and its range."""


class InvalidTypeError(LocalProtocolError, TypeError):
    """A call was given an argument of a type that it does not accept; the text names the argument."""


class InvalidStateError(LocalProtocolError, RuntimeError):
    """A call is not possible now, such as sending through a node that is not open."""


class FieldNameError(LocalProtocolError, TypeError):
    """A message was given a field that its definition does not have."""


class FieldTypeError(LocalProtocolError, TypeError):
    """A message field was given a value of a kind that it cannot hold."""


class FieldRangeError(LocalProtocolError, ValueError):
    """A message field was given a value outside the range of its type; the text names the range."""


class SetpointError(FieldRangeError):
    """A setpoint that no vehicle could follow."""


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


class ParameterFileError(MavstackError):
    """A file of parameters cannot be read or written; `path` and `line` say where."""

    def __init__(self, problem: str, path: str | None = None, line: int | None = None) -> None:
        self.problem = problem
        self.path = path
        self.line = line
        where = "" if path is None else f"{path}: " if line is None else f"{path}:{line}: "
        super().__init__(where + problem)

    def __reduce__(self) -> tuple[type[ParameterFileError], tuple[str, str | None, int | None]]:
        return type(self), (self.problem, self.path, self.line)


class PlanFileError(MavstackError):
    """A file of plans cannot be read or written; `path` and `where` (a line or a key) say where."""

    def __init__(self, problem: str, path: str = "", where: str = "") -> None:
        self.problem = problem
        self.path = path
        self.where = where
        super().__init__(": ".join(filter(None, (path, where, problem))))

    def __reduce__(self) -> tuple[type[PlanFileError], tuple[str, str, str]]:
        return type(self), (self.problem, self.path, self.where)


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


class RemoteError(MavstackError):
    """Something asked of another component did not come to a good end.

    `request` says what was asked, `target` of whom, `attempts` how often, `answer` what came back; `said` is
    what the component told people about it meanwhile (STATUSTEXT), if anything.
    """

    said: tuple[str, ...] = ()

    def __init__(self, request: str, target: str, *, attempts: int = 1, answer: str = "no answer") -> None:
        self.request = request
        self.target = target
        self.attempts = attempts
        self.answer = answer
        often = "" if attempts <= 1 else f" {attempts} times"
        super().__init__(f"{request} asked of {target}{often}: {answer}")

    def __str__(self) -> str:
        said = "; ".join(self.said)
        return f"{self.args[0]} ({said})" if said else str(self.args[0])

    def __reduce__(self) -> tuple[object, ...]:
        return _remade, (type(self), self.args, self.__dict__)


def _remade(kind: type[RemoteError], args: tuple[str, ...], state: dict[str, object]) -> RemoteError:
    error = kind.__new__(kind, *args)
    error.args = args  # which TimeoutError, an OSError, leaves to its own __init__
    error.__dict__.update(state)
    return error


class RemoteTimeout(RemoteError, TimeoutError):
    """The other component did not answer in time."""


class RemoteDenied(RemoteError):
    """The other component answered that it will not; `code` is its reason as the service numbers it."""

    def __init__(self, request: str, target: str, *, attempts: int = 1, answer: str, code: int = 0) -> None:
        super().__init__(request, target, attempts=attempts, answer=answer)
        self.code = code


class RemoteCancelled(RemoteError):
    """The operation was cancelled, by either side, before it came to an end."""


class RemoteProtocolError(RemoteError):
    """The other component's answers contradict the protocol or each other."""


class CommandDenied(RemoteDenied):
    """A command was refused; `code` is its MAV_RESULT, `detail` its `result_param2`."""

    detail: int = 0


class CommandTimeout(RemoteTimeout):
    """A command was not acknowledged, or not finished, in time."""


class MessageTimeout(RemoteTimeout):
    """A requested message did not come."""


class ParameterDenied(RemoteDenied):
    """A parameter was refused; `code` is its MAV_PARAM_ERROR or PARAM_ACK."""


class ParameterTimeout(RemoteTimeout):
    """A parameter was not answered in time, or the set of parameters never became whole."""


class MissionDenied(RemoteDenied):
    """A plan was refused; `code` is its MAV_MISSION_RESULT, `item` the item it was about, if about one."""

    item: int | None = None


class MissionTimeout(RemoteTimeout):
    """A plan's transfer stopped before its end."""


class FileDenied(RemoteDenied):
    """A file operation was refused; `code` is the FTP error, `errno` the remote system's, if it told."""

    errno: int | None = None


class FileTimeout(RemoteTimeout):
    """A file operation stopped before its end."""


class LogTimeout(RemoteTimeout):
    """A log's transfer stopped before its end."""


class ModeTimeout(RemoteTimeout):
    """A mode was not entered in time, though perhaps accepted, or the list of modes never became whole."""


class ActionTimeout(RemoteTimeout):
    """A vehicle took on what it was asked, and then did not get it done, or stopped getting on with it."""


class ContactLost(RemoteTimeout):
    """A vehicle fell silent while it did what it was asked; what became of that is not known."""


class ActionInterrupted(RemoteError):
    """A vehicle took on what it was asked, then did something else: a failsafe, a pilot, another station."""


class ActionUnsupported(LocalProtocolError):
    """No vehicle of this kind, or no firmware like its own, can do what is asked; nothing was sent."""


class HealthTimeout(RemoteTimeout):
    """A vehicle did not become ready to arm in time; the text holds what it lacks."""


class GroupError(MavstackError):
    """Some vehicles of a group did not do what was asked of all; `errors` tells why, by system id."""

    def __init__(self, what: str, errors: dict[int, Exception], total: int) -> None:
        self.what = what
        self.errors = errors
        self.total = total
        super().__init__(what, errors, total)

    def __str__(self) -> str:
        by_reason: dict[str, list[int]] = {}
        for system, error in self.errors.items():
            by_reason.setdefault(_reason(error), []).append(system)
        head = f"{self.what}: {len(self.errors)} of {self.total} vehicles failed"
        lines = [f"  {', '.join(map(str, systems))}: {reason}" for reason, systems in by_reason.items()]
        return "\n".join([head, *lines])

    @staticmethod
    def expects(error: Exception) -> bool:
        """Whether an error is one that vehicles and links cause, not a defect of the program."""
        return isinstance(error, MavstackError)


def _reason(error: Exception) -> str:
    """Why one vehicle failed, in words that are the same for all that failed for the same reason."""
    if isinstance(error, RemoteError):
        return str(error).replace(f" asked of {error.target}", "", 1)
    text = " ".join(str(error).split())
    return text if isinstance(error, MavstackError) else f"{type(error).__name__}: {text}"
