from __future__ import annotations

import inspect
import re

from mavstack.services import service
from mavstack.services.service import Service

#: Methods that services call themselves or override beside the contract.
OTHERS = {"bulk_messages", "send", "emit"}


def test_each_row_of_the_contract_begins_with_a_method_as_it_is_declared() -> None:
    """A reflow of the text would join the rows."""
    rows = re.findall(r"^    (\w+)\((.*?)\)  +\S.*$", service.__doc__ or "", re.MULTILINE)
    methods = {
        name: ", ".join(list(inspect.signature(method).parameters)[1:])
        for name, method in inspect.getmembers(Service, inspect.isfunction)
        if not name.startswith("_") and name not in OTHERS
    }
    assert dict(rows) == methods
    assert len(rows) == len(methods)
