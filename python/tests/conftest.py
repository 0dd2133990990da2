"""What several tests share."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import jointplay as jp

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def gpr() -> jp.Gpr:
    return jp.Gpr.paper()


@pytest.fixture
def rods() -> np.ndarray:
    """A few hundred rods within the stroke, some degrees of tilt."""
    return np.random.default_rng(7).uniform(0.498, 0.502, (300, 3))


@pytest.fixture(scope="session")
def ask():
    """Asks the `jointplay` command, which `python/test.py` has built, and reads its answer."""

    def answer(*arguments: str) -> dict:
        command = [os.environ["JOINTPLAY_COMMAND"], *arguments, "--format", "json"]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        return json.loads(done.stdout)

    return answer
