"""Files of parameters: read, written, compared with a vehicle, and loaded into one."""

from mavstack.vehicle.parameter_files.compare import AnyParameter, Comparison, Difference, compare, value_text
from mavstack.vehicle.parameter_files.files import parse_parameters, read_parameters, write_parameters
from mavstack.vehicle.parameter_files.format import ParameterFormat
from mavstack.vehicle.parameter_files.kinds import Owner, needs_reboot, owner_of
from mavstack.vehicle.parameter_files.load import Applied, Outcome, ParameterLoad, apply
from mavstack.vehicle.parameter_files.numbers import read_number, write_number
from mavstack.vehicle.parameter_files.registry import FORMATS, format_for
from mavstack.vehicle.parameter_files.stored import ParameterFile, StoredParameter

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
