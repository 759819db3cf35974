"""The extended parameter protocol, whose values may be text: client and server."""

from mavstack.services.extended_parameters.client import ExtendedParameterChanged, ExtendedParameterClient
from mavstack.services.extended_parameters.operations import (
    DownloadExtendedParameters,
    GetExtendedParameter,
    SetExtendedParameter,
)
from mavstack.services.extended_parameters.server import (
    ExtendedParameterServer,
    ExtendedParameterWritten,
    ExtendedSetRequest,
    ExtendedSetStarted,
)
from mavstack.services.extended_parameters.value import ExtendedParameter, ExtendedValue

__all__ = [
    "DownloadExtendedParameters",
    "ExtendedParameter",
    "ExtendedParameterChanged",
    "ExtendedParameterClient",
    "ExtendedParameterServer",
    "ExtendedParameterWritten",
    "ExtendedSetRequest",
    "ExtendedSetStarted",
    "ExtendedValue",
    "GetExtendedParameter",
    "SetExtendedParameter",
]
