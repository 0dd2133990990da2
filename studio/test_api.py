"""Hold the studio's server to its own OpenAPI description.

Starts `jointplay studio`, has schemathesis send it thousands of requests, valid and invalid ones, and ends it by Ctrl-C.
Everything that it makes and downloads is in `target/studio`; with `--prepare` it only fetches schemathesis.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HOME = ROOT / "target" / "studio"
SCHEMATHESIS = "schemathesis==4.32.5"
EXAMPLES = 25


def environment() -> Path:
    """A Python of our own with schemathesis; made once."""
    folder = HOME / SCHEMATHESIS
    bin = folder / ("Scripts" if os.name == "nt" else "bin")
    mark = folder / "complete"
    if not mark.exists():
        venv.create(folder, with_pip=True, clear=True)
        subprocess.run([bin / "python", "-m", "pip", "install", "-q", "--no-compile", SCHEMATHESIS], check=True)
        mark.touch()
    return bin


def main() -> int:
    """The exit code of schemathesis, or 1 where the server misbehaves."""
    command, bin = Path(sys.argv[1]), environment()
    cell = HOME / "cell" / "mine.toml"
    cell.parent.mkdir(exist_ok=True)
    shutil.copy(ROOT / "crates/jointplay-format/cells" / "example.toml", cell)
    cell.with_suffix(".program").write_text("HOME\n")
    mechanism = HOME / "cell" / "linkage.toml"
    shutil.copy(ROOT / "crates/jointplay-format/robots" / "bennett.toml", mechanism)
    server = subprocess.Popen(
        [command, "studio", "--no-open", "--port", "0", "--cell", cell, "--mechanism", mechanism],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        line = server.stdout.readline()
        url = re.search(r"http://\S+", line)
        if url is None:
            print(f"the server did not start: {line}", file=sys.stderr)
            return 1
        run = subprocess.run(
            [
                bin / "st",
                "--config-file",
                ROOT / "studio" / "schemathesis.toml",
                "run",
                f"{url.group()}api/v1/openapi.json",
                f"--max-examples={EXAMPLES}",
                # The same requests every time, so that a failure can be looked at.
                "--seed=1",
            ],
            cwd=HOME,
        )
        server.send_signal(signal.SIGINT)
        ended = server.wait(timeout=10)
        if ended != 0:
            print(f"the server ended with exit code {ended}", file=sys.stderr)
        return run.returncode or ended
    finally:
        server.kill()


if __name__ == "__main__":
    if sys.argv[1] == "--prepare":
        environment()
    else:
        sys.exit(main())
