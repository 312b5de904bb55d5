"""The `abbe` program. `python -m abbe` and the command `abbe` of the package are the same."""

import sys

from . import _native


def main() -> int:
    """Runs the program with the words of the command line, and returns its exit status."""
    return _native.run_command_line(["abbe", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
