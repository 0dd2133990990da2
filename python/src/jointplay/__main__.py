"""The command ``jointplay``, which ``python -m jointplay`` also runs."""

import signal
import sys

from ._jointplay import run_command


def main() -> None:
    """Runs the command with the arguments of this process, and exits with its exit code."""
    # Python would handle an interrupt only after the command has ended.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(run_command(["jointplay", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
