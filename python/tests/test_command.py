"""The command that the package includes, as its users start it."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import sysconfig
import urllib.request
from pathlib import Path

import jointplay as jp
import pytest

COMMAND = Path(sysconfig.get_path("scripts")) / ("jointplay.exe" if os.name == "nt" else "jointplay")


def run(*arguments: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([COMMAND, *arguments], capture_output=True, check=False, timeout=60)


def test_answers_are_those_of_the_native_command() -> None:
    for line in ["--version", "--help", "mobility hexapod", "mobility hexapod --format json", "completions bash"]:
        ours = run(*line.split())
        native = subprocess.run([os.environ["JOINTPLAY_COMMAND"], *line.split()], capture_output=True, check=False)
        assert (ours.returncode, ours.stdout, ours.stderr) == (0, native.stdout, native.stderr), line


def test_the_module_is_the_command() -> None:
    line = [sys.executable, "-m", "jointplay", "--version"]
    assert subprocess.check_output(line).decode() == f"jointplay {jp.__version__}\n"


def test_exit_codes() -> None:
    refused = run("mobility", "no-such-mechanism", "--format", "json")
    assert refused.returncode == 2 and "no-such-mechanism" in json.loads(refused.stderr)["error"]["message"]
    too_far = run("inverse", "--azimuth-deg", "0", "--tilt-deg", "45")
    assert too_far.returncode == 1 and too_far.stdout == b""


def test_numbers_are_those_of_the_package() -> None:
    answer = json.loads(run("inverse", "--azimuth-deg", "0", "--tilt-deg", "1", "--format", "json").stdout)
    rods = jp.Gpr.paper().inverse(azimuth_rad=0.0, tilt_rad=0.017453292519943295)
    assert [rod * 1e-3 for rod in answer["q_mm"]] == pytest.approx(list(rods.rods_m), rel=1e-15)


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_the_studio_serves_its_page_until_interrupted() -> None:
    line = [COMMAND, "studio", "--no-open", "--port", "0"]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            address = next(found[0] for text in server.stdout if (found := re.findall(r"http://[\w.:]+", text)))
            with urllib.request.urlopen(address, timeout=30) as answer:
                page = answer.read().decode()
            (script, *_) = re.findall(r'src="\.?/?([^"]+\.js)"', page)
            with urllib.request.urlopen(f"{address}/{script}", timeout=30) as answer:
                assert answer.headers["Content-Type"].startswith("text/javascript") and answer.read()
            server.send_signal(signal.SIGINT)
            assert server.wait(30) in (0, 130)
        finally:
            server.kill()
