"""`python -m mavstack` is `mav`."""

from __future__ import annotations

import sys

from mavstack.cli.entry import main

if __name__ == "__main__":
    sys.exit(main())
