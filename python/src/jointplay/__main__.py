"""The ``jointplay`` command, also as ``python -m jointplay``."""

import signal
import sys

from ._jointplay import run_command


def main() -> None:
    """Runs the command with the arguments of this process, and ends the process with its exit code."""
    # Python would handle an interruption only after the command.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(run_command(["jointplay", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
