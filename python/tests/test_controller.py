"""The simulated controller with a host in Python."""

from __future__ import annotations

import json
import os
import socket
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


@pytest.fixture
def equipment(controller):
    """The port of GEM equipment in front of the controller."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    example = ROOT / "examples" / "gem_equipment.py"
    with subprocess.Popen([sys.executable, str(example), controller, port], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline().startswith(f"equipment at 127.0.0.1:{port}: READY ")
        yield port
        process.kill()


def test_a_gem_host_transfers_wafers(equipment):
    example = ROOT / "examples" / "gem_host.py"
    command = [sys.executable, str(example), equipment, "LP1", "LP2", "A"]
    done = subprocess.run([*command, "2"], check=True, stdout=subprocess.PIPE, text=True, timeout=60)
    lines = done.stdout.splitlines()
    assert [line.split(": ")[1] for line in lines[:2]] == ["COMPLETED", "COMPLETED"]
    durations = [float(line.split()[0]) for line in lines[:3]]
    assert durations[0] + durations[1] == pytest.approx(durations[2], abs=0.002) and durations[0] > 5
    assert lines[3].startswith("STATUS idle ")
    # A second host finds the slots empty: the reason of the controller reaches it.
    done = subprocess.run([*command, "1"], check=True, stdout=subprocess.PIPE, text=True, timeout=60)
    assert "REFUSED 4 slot 1 of LP1 is empty" in done.stdout.splitlines()[0]
