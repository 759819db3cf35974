"""Files of parameters: read, written, compared with a vehicle, and loaded into one."""

from mavstack.files.parameters.compare import AnyParameter, Comparison, Difference, compare, value_text
from mavstack.files.parameters.files import parse_parameters, read_parameters, write_parameters
from mavstack.files.parameters.format import ParameterFormat
from mavstack.files.parameters.kinds import Owner, needs_reboot, owner_of
from mavstack.files.parameters.load import Applied, Outcome, ParameterLoad, apply
from mavstack.files.parameters.numbers import read_number, write_number
from mavstack.files.parameters.registry import FORMATS, format_for
from mavstack.files.parameters.stored import ParameterFile, StoredParameter

__all__ = [
    "FORMATS",
    "AnyParameter",
    "Applied",
    "Comparison",
    "Difference",
    "Outcome",
    "Owner",
    "ParameterFile",
    "ParameterFormat",
    "ParameterLoad",
    "StoredParameter",
    "apply",
    "compare",
    "format_for",
    "needs_reboot",
    "owner_of",
    "parse_parameters",
    "read_number",
    "read_parameters",
    "value_text",
    "write_number",
    "write_parameters",
]
