"""The messages that a vehicle sends, as they arrive: streams, waits, listeners, and their rates."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import Message
from mavstack.errors import CommandTimeout, MessageTimeout, RemoteCancelled
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.services.message_request.interval import name_of
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.telemetry.stream import MessageStream

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.dispatch import Listener
    from mavstack.vehicle.vehicle import Vehicle
    from mavstack.wire import Packet

AnyMessage = TypeVar("AnyMessage", bound=Message)


def stream(
    vehicle: Vehicle, *messages: type[AnyMessage], rate: float | None = None, queue: int = 1000
) -> MessageStream[AnyMessage]:
    """Return an async iterator of the autopilot's messages of these classes, as they arrive.

    Args:
        *messages: The message classes; none of them: all messages.
        rate: The rate to request while the stream is open, in hertz; None requests a default rate, and
            only for messages that the vehicle does not send by itself.
        queue: The number of unread messages that are kept; a slow reader loses the oldest.

    Returns:
        The stream; reading it raises `CommandDenied` if the vehicle refuses the rate and sends nothing.

    Raises:
        InvalidArgumentError: A rate without message classes.
    """
    subscription = vehicle.component.stream(*messages, queue=queue)
    return MessageStream(vehicle.telemetry, messages, subscription, rate)


async def wait_for_message(
    vehicle: Vehicle, message: type[AnyMessage], *, timeout: float | None = DEFAULT_WAIT_TIMEOUT
) -> AnyMessage:
    """Return the next message of a class, which is requested if the vehicle does not send it by itself.

    Args:
        message: The message class.
        timeout: Seconds to wait; None waits for ever.

    Returns:
        The message.

    Raises:
        MessageTimeout: No message arrived in time.
        CommandDenied: The vehicle refused to send the message, and none arrived.
        RemoteCancelled: The connection was closed.
    """
    operation, target = f"waiting for {name_of(message)} from", str(vehicle.address)
    async with stream(vehicle, message) as messages:
        try:
            async with asyncio.timeout(timeout):
                return await anext(messages)
        except TimeoutError:
            raise MessageTimeout(operation, target, answer=f"none arrived in {timeout:g} s") from None
        except StopAsyncIteration:
            raise RemoteCancelled(operation, target, answer="the connection was closed") from None


def add_listener(
    vehicle: Vehicle,
    message: type[AnyMessage] | tuple[type[AnyMessage], ...],
    callback: Callable[[AnyMessage], object],
    *,
    component: int | None = None,
) -> Listener:
    """Call a function with each message of a class as soon as it is received.

    Args:
        message: The message class, or a tuple of classes.
        callback: A plain function, which must return quickly. An exception that it raises goes to the
            event loop's exception handler.
        component: The component id of the sender; None is the autopilot.

    Returns:
        The registration; its `close()` unregisters the function.
    """
    system, autopilot = vehicle.address
    names = ", ".join(map(name_of, message if isinstance(message, tuple) else (message,)))

    def deliver(packet: Packet) -> None:
        try:
            callback(packet.message)
        except Exception as error:  # noqa: BLE001 (a defect of the program must not stop the link)
            context = {"message": f"the listener for {names} failed", "exception": error}
            asyncio.get_running_loop().call_exception_handler(context)

    source = autopilot if component is None else component
    return vehicle.connection.add_packet_listener(message, deliver, system=system, component=source)


async def set_message_rate(
    vehicle: Vehicle, message: type[Message], rate: float | None, *, timeout: float | None = None
) -> None:
    """Request a message from the autopilot at a rate, permanently.

    The rate is requested again after a reboot (SET_MESSAGE_INTERVAL).

    Args:
        message: The message class.
        rate: Hertz; None returns to the rate at which the vehicle sends the message by itself.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        CommandDenied: The vehicle refused the rate.
        CommandTimeout: The vehicle did not answer in time.
    """
    rates = vehicle.telemetry.rates
    rates.set_permanently(message, rate)
    operation = f"setting the rate of {name_of(message)} on"
    async with deadline(timeout, operation, vehicle.address, CommandTimeout):
        await rates.ask(message)


def rc_pulse(vehicle: Vehicle, channel: int) -> int | None:
    """Return the pulse of a radio control channel.

    Args:
        channel: The number of the channel, from 1.

    Returns:
        Microseconds, or None if the channel is unused or was not received (RC_CHANNELS).
    """
    rc = vehicle.rc
    return rc.channels[channel - 1] if rc is not None and channel <= len(rc.channels) else None
