"""Runs fake motors: python -m rc10.fakes."""

import sys

from rc10.fakes.cli import main

if __name__ == "__main__":
    sys.exit(main())
