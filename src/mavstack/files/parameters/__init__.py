"""Parameter files: read, written, compared with a vehicle's parameters, and loaded into a vehicle."""

from mavstack.files.parameters.compare import AnyParameter, Comparison, Difference, compare, value_text
from mavstack.files.parameters.file_access import parse_parameters, read_parameters, write_parameters
from mavstack.files.parameters.format import ParameterFormat
from mavstack.files.parameters.load import AppliedParameter, Outcome, ParameterLoad, apply
from mavstack.files.parameters.numbers import read_number, write_number
from mavstack.files.parameters.parameter_file import ParameterFile, StoredParameter
from mavstack.files.parameters.registry import FORMATS, format_for
from mavstack.files.parameters.traits import Owner, needs_reboot, owned_patterns, owner_of

__all__ = [
    "FORMATS",
    "AnyParameter",
    "AppliedParameter",
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
    "owned_patterns",
    "owner_of",
    "parse_parameters",
    "read_number",
    "read_parameters",
    "value_text",
    "write_number",
    "write_parameters",
]
