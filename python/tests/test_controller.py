"""The simulated controller with a host in Python."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
from conftest import ROOT


@pytest.fixture
def controller():
    """The address of a running controller."""
    command = [os.environ["JOINTPLAY_COMMAND"], "cell", "serve", "--listen", "127.0.0.1:0", "--speed", "1000"]
    with subprocess.Popen([*command, "--format", "json"], stdout=subprocess.PIPE, text=True) as process:
        text = ""
        while "}" not in text:
            line = process.stdout.readline()
            assert line, text
            text += line
        yield json.loads(text)["address"]
        process.kill()


def test_the_example_host_moves_wafers(controller, ask, tmp_path):
    example = ROOT / "examples" / "controller_host.py"
    command = [sys.executable, str(example), controller, "LP1", "LP2", "A", "2"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    lines = done.stdout.splitlines()
    assert lines[0].startswith("READY ")
    assert lines[-1] == "MAP LP2 1 1 " + " ".join(["0"] * 23)
    # The whole as a program takes the same time.
    program = tmp_path / "lot.program"
    program.write_text("REPEAT 2 AS n\n  TRANSFER LP1 SLOT n TO LP2 SLOT n WITH A\nEND\n")
    report = ask("cell", "check", "example", str(program))
    total = float(lines[-2].split()[0])
    assert total == pytest.approx(report["duration_s"], abs=0.005)
