"""Imports of programs with a vehicle: libraries that take long and that such a program does not need."""

import subprocess
import sys


def test_a_vehicle_imports_no_client_of_http_and_no_fractions():
    program = "import sys\nimport mavstack.vehicle\nprint(' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True)
    assert {"http.client", "urllib.request", "fractions"}.isdisjoint(done.stdout.split())
