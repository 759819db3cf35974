"""The exception tree: every error that Mavstack raises on purpose derives from `MavstackError`.

Bad input from the wire never raises; it is counted. Errors are raised for a wrong definition, a link that
cannot be opened, misuse by the calling program (`LocalProtocolError`), and a remote component that refuses,
contradicts the protocol or does not answer (`RemoteError`). Misuse also derives from the expected built-in.
"""

from __future__ import annotations


class MavstackError(Exception):
    """Base of every error that Mavstack raises on purpose."""


class LocalProtocolError(MavstackError):
    """Misuse by the calling program: a request that the protocol or the API does not allow."""


class InvalidArgumentError(LocalProtocolError, ValueError):
    """An argument has a value that the call does not accept; the text names the argument and its range."""


class InvalidTypeError(LocalProtocolError, TypeError):
    """An argument has a type that the call does not accept; the text names the argument."""


class InvalidStateError(LocalProtocolError, RuntimeError):
    """A call is not possible in the present state, such as sending through a node that is not open."""


class FieldNameError(LocalProtocolError, TypeError):
    """A message was given a field name that its definition does not have."""


class FieldTypeError(LocalProtocolError, TypeError):
    """A message field was given a value of a type that it cannot hold."""


class FieldRangeError(LocalProtocolError, ValueError):
    """A message field was given a value outside the range of its type; the text names the range."""


class SetpointError(InvalidArgumentError):
    """A setpoint that no vehicle could follow: nothing controlled, or a number that is not finite."""


class CdrError(LocalProtocolError, ValueError):
    """Values do not fit a ROS message, or bytes are not one."""


class EncodeError(LocalProtocolError, ValueError):
    """A message cannot be encoded as requested, such as an id above 255 in MAVLink 1."""


class SigningError(LocalProtocolError, ValueError):
    """A signing key, link id or timestamp is not usable; the text never holds the key."""


class LocatedError(MavstackError):
    """A file that cannot be read: `path` and `line` locate the problem, as far as they are known."""

    def __init__(self, problem: str, path: str | None = None, line: int | None = None) -> None:
        self.problem = problem
        self.path = path
        self.line = line
        where = "" if path is None else f"{path}:{line}: " if line is not None else f"{path}: "
        super().__init__(where + problem)

    def __reduce__(self) -> tuple[type[LocatedError], tuple[str, str | None, int | None]]:
        return type(self), (self.problem, self.path, self.line)


class DialectError(LocatedError):
    """A definition file is missing, malformed or contradicts itself; `path` and `line` locate the problem."""


class UnknownMessageError(MavstackError, KeyError):
    """A dialect has no message with that name or id."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class UnknownDialectError(DialectError, KeyError):
    """There is no official dialect with that name."""

    def __str__(self) -> str:
        return Exception.__str__(self)


class LogError(MavstackError):
    """A log file cannot be read at all; damage inside a log is counted and never raised."""


class ParameterFileError(LocatedError):
    """A parameter file cannot be read or written; `path` and `line` locate the problem."""


class MetadataError(LocatedError):
    """Metadata of a component or its parameters cannot be read; `path` and `line` locate the problem."""


class RouterConfigError(LocatedError):
    """A configuration of the router cannot be read; `path` and `line` locate the problem."""


class PlanFileError(MavstackError):
    """A plan file cannot be read or written; `path` and `where` (a line or a key) locate the problem."""

    def __init__(self, problem: str, path: str = "", where: str = "") -> None:
        self.problem = problem
        self.path = path
        self.where = where
        super().__init__(": ".join(filter(None, (path, where, problem))))

    def __reduce__(self) -> tuple[type[PlanFileError], tuple[str, str, str]]:
        return type(self), (self.problem, self.path, self.where)


class LinkError(MavstackError):
    """A link cannot be opened or used; the text names the URL and the remedy."""


class LinkURLError(LinkError, ValueError):
    """A link URL is malformed, or names an unknown scheme or option."""


class LinkClosedError(LinkError):
    """The link or channel is closed."""


class RadioError(MavstackError):
    """A telemetry radio does not answer or refuses a command; the text holds the reason and the remedy."""

    def __init__(self, text: str, *, refused: bool = False) -> None:
        self.refused = refused  # True if the radio answered ERROR
        super().__init__(text)


class MissingExtraError(MavstackError, ImportError):
    """A feature needs an optional dependency; the text holds the command that installs it."""

    def __init__(self, feature: str, extra: str) -> None:
        self.feature = feature
        self.extra = extra
        super().__init__(f"{feature} needs an extra: pip install 'mavstack[{extra}]'")

    def __reduce__(self) -> tuple[type[MissingExtraError], tuple[str, str]]:
        return type(self), (self.feature, self.extra)


class RemoteError(MavstackError):
    """An operation on a remote component failed.

    The text reads `<operation> <target> failed[ after N attempts]: <answer>[ (<status text>; …)]`, such as
    "arming 1/1 failed: FAILED (PreArm: need position estimate)".

    Attributes:
        operation: The operation as a gerund or a command name, with the preposition that leads to the
            target: "arming", "NAV_TAKEOFF on", "reading parameter RTL_ALT of".
        target: The remote component, "system/component", or the links of a call that waited for a component.
        attempts: The number of requests that were sent.
        answer: The remote component's answer, or the reason for the failure.
        status_texts: The status texts (STATUSTEXT) that the vehicle sent meanwhile, oldest first.
        events: The messages of PX4's events (EVENT) meanwhile; in the text if there are no status texts.
        not_restored: The changes of earlier steps that could not be undone, such as "mode RTL (it is in
            GUIDED)"; empty if the vehicle is as before the call.
        limit: The argument that allows more where a limit was exceeded, such as "timeout"; else empty.
    """

    status_texts: tuple[str, ...] = ()
    events: tuple[str, ...] = ()
    not_restored: tuple[str, ...] = ()

    def __init__(
        self, operation: str, target: str, *, attempts: int = 1, answer: str = "no answer", limit: str = ""
    ) -> None:
        self.limit = limit
        self.operation = operation
        self.target = target
        self.attempts = attempts
        self.answer = answer
        super().__init__(f"{operation} {target} {self._outcome()}")

    def __str__(self) -> str:
        return f"{self.args[0]}{self._additions()}"

    def __reduce__(self) -> tuple[object, ...]:
        return _restore, (type(self), self.args, self.__dict__)

    def rename(self, operation: str) -> None:
        """Name the operation of which the failed one was all: "arming", not "COMPONENT_ARM_DISARM on".

        Args:
            operation: The operation, as in the attribute of this name.
        """
        self.operation = operation
        self.args = (f"{operation} {self.target} {self._outcome()}",)

    def without_target(self) -> str:
        """Return the text without the target: the same for all targets that failed for one reason."""
        operation = self.operation
        for preposition in _PREPOSITIONS:
            operation = operation.removesuffix(preposition)
        return f"{operation} {self._outcome()}{self._additions()}"

    def _additions(self) -> str:
        texts = f" ({'; '.join(reasons)})" if (reasons := self.status_texts or self.events) else ""
        return f"{texts}; not restored: {', '.join(self.not_restored)}" if self.not_restored else texts

    def _outcome(self) -> str:
        attempts = "" if self.attempts <= 1 else f" after {self.attempts} attempts"
        return f"failed{attempts}: {self.answer}"


_PREPOSITIONS = (" of", " on", " to", " from", " with")


def _restore(kind: type[RemoteError], args: tuple[str, ...], state: dict[str, object]) -> RemoteError:
    error = kind.__new__(kind, *args)
    error.args = args  # set `args` here: OSError, a base of TimeoutError, sets it only in __init__
    error.__dict__.update(state)
    return error


class RemoteTimeout(RemoteError, TimeoutError):
    """The remote component did not answer in time, or the operation stopped making progress."""


class RemoteDenied(RemoteError):
    """The remote component refused the operation; `code` is the service's number of its reason."""

    def __init__(self, operation: str, target: str, *, attempts: int = 1, answer: str, code: int = 0) -> None:
        super().__init__(operation, target, attempts=attempts, answer=answer)
        self.code = code


class RemoteCancelled(RemoteError):
    """The operation was cancelled by either side, or the connection was closed, before it ended."""


class RemoteProtocolError(RemoteError):
    """The remote component's answers contradict the protocol or each other."""


class CommandDenied(RemoteDenied):
    """A command was refused; `code` is its MAV_RESULT, `detail` its `result_param2`."""

    detail: int = 0


class CommandTimeout(RemoteTimeout):
    """A command was not acknowledged, or its acknowledged work did not end, in time."""


class ActionRefused(CommandDenied):
    """An action that the vehicle's state does not allow, such as takeoff before arming; nothing was sent."""


class MessageTimeout(RemoteTimeout):
    """A requested message did not arrive in time."""


class ParameterDenied(RemoteDenied):
    """Reading or setting a parameter was refused; `code` is its MAV_PARAM_ERROR or PARAM_ACK."""


class ParameterTimeout(RemoteTimeout):
    """A parameter did not arrive in time, or the parameter set stayed incomplete."""


class MissionDenied(RemoteDenied):
    """A plan was refused; `code` is its MAV_MISSION_RESULT, `item` the refused item's number."""

    item: int | None = None


class MissionTimeout(RemoteTimeout):
    """The transfer of a plan stopped before it was complete."""


class FileDenied(RemoteDenied):
    """A file operation was refused; `code` is the MAV_FTP_ERR, `errno` that of the remote system, if sent."""

    errno: int | None = None


class FileTimeout(RemoteTimeout):
    """A file operation stopped before it was complete."""


class LogTimeout(RemoteTimeout):
    """The transfer of a log, or of the list of logs, stopped before it was complete."""


class ModeTimeout(RemoteTimeout):
    """A mode was not entered in time, even if it was accepted, or the list of modes stayed incomplete."""


class ActionTimeout(RemoteTimeout):
    """A vehicle accepted an action, then did not complete it in time or stopped making progress."""


class ContactLost(RemoteTimeout):
    """No heartbeat of the vehicle arrived during an action; the outcome of the action is not known."""


class ActionInterrupted(RemoteError):
    """A vehicle accepted an action, then left it: a failsafe, a pilot or another ground station took over."""


class SystemIdConflictError(RemoteError):
    """Several vehicles use the system id of the target, and none was chosen; nothing was sent.

    The text names the senders: their channels, and what tells them apart.
    """


class ActionUnsupported(LocalProtocolError):
    """The vehicle type or the firmware does not support the action; nothing was sent."""


class MspError(RemoteError):
    """A request to a flight controller of Betaflight or iNav failed."""


class MspTimeout(MspError, RemoteTimeout):
    """A flight controller did not answer in time."""


class MspDenied(MspError, RemoteDenied):
    """A flight controller answered with an error: it does not know the command, or its state forbids it."""


class MspDecodeError(MspError, RemoteProtocolError):
    """A message of a flight controller does not have the layout of its definition."""


class MspSettingError(MspError):
    """A setting of a flight controller has another value than the one that was written."""


class MspFirmwareError(MspError):
    """The firmware or its version is not supported; the text holds the reason."""


class HealthTimeout(RemoteTimeout):
    """A vehicle did not become ready to arm in time; the text holds the failed checks."""


class MissionWarning(UserWarning):
    """A mission that was uploaded, but is probably not what was intended (a warning, not an error)."""


class SwarmStopped(MavstackError):
    """A swarm was stopped, and its members stand; `systems` are the vehicles that caused it."""

    def __init__(self, reason: str, systems: tuple[int, ...] = ()) -> None:
        self.systems = systems
        super().__init__(reason, systems)

    def __str__(self) -> str:
        return f"the swarm was stopped: {self.args[0]}"


class GroupError(MavstackError):
    """An operation failed on some vehicles of a group.

    Attributes:
        operation: The operation as a gerund: "arming".
        errors: The error of each vehicle that failed, by system id.
        total: The number of vehicles in the group.
    """

    def __init__(self, operation: str, errors: dict[int, Exception], total: int) -> None:
        self.operation = operation
        self.errors = errors
        self.total = total
        super().__init__(operation, errors, total)

    def __str__(self) -> str:
        by_reason: dict[str, list[int]] = {}
        for system, error in self.errors.items():
            by_reason.setdefault(_reason(error), []).append(system)
        head = f"{self.operation} failed on {len(self.errors)} of {self.total} vehicles"
        lines = [f"  {', '.join(map(str, systems))}: {reason}" for reason, systems in by_reason.items()]
        return "\n".join([head, *lines])

    @staticmethod
    def expects(error: Exception) -> bool:
        """Return whether vehicles and links can cause this error, so that it is no defect of the program."""
        return isinstance(error, MavstackError)


def _reason(error: Exception) -> str:
    """Return the text of one vehicle's error, the same for all vehicles that failed for one reason."""
    if isinstance(error, RemoteError):
        return error.without_target()
    text = " ".join(str(error).split())
    return text if isinstance(error, MavstackError) else f"{type(error).__name__}: {text}"
