"""Files beside pymavlink's reader and writer, which MAVProxy uses."""

from __future__ import annotations

import contextlib
import io

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pymavlink.mavparm import MAVParmDict

from mavstack.files.parameters import ParameterFile, compare, read_parameters, write_parameters
from mavstack.services.parameters import Parameter
from tests.files.parameters.test_formats import plain_files

SINGLES = st.floats(-1e9, 1e9, width=32)


def loaded(path):
    with contextlib.redirect_stdout(io.StringIO()):
        found = MAVParmDict()
        assert found.load(str(path), use_excludes=False)
    return dict(found)


@pytest.mark.parametrize("suffix", [".param", ".parm"])
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(file=plain_files())
def test_pymavlink_reads_written_files(tmp_path, suffix, file):
    path = tmp_path / f"ours{suffix}"
    unmarked = ParameterFile(tuple(each for each in file.parameters if not each.read_only))
    write_parameters(path, unmarked)
    theirs = loaded(path)
    assert list(theirs) == [each.name for each in unmarked.parameters]
    assert not unmarked.parameters or read_parameters(path).by_name().keys() == theirs.keys()
    for name, each in read_parameters(path).by_name().items() if theirs else ():
        assert theirs[name] == float(each.value)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(values=st.dictionaries(st.from_regex(r"[A-Z][A-Z0-9_]{0,15}", fullmatch=True), SINGLES, min_size=1))
def test_a_file_saved_by_pymavlink_equals_the_vehicle(tmp_path, values):
    path = tmp_path / "theirs.parm"
    saved = MAVParmDict()
    saved.update(values)
    saved.save(str(path))
    vehicle = {name: Parameter(name, value) for name, value in values.items()}
    found = compare(read_parameters(path).by_name(), vehicle)
    assert found.alike, found
