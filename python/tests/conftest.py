"""What several tests share."""

from __future__ import annotations

import os
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
def command() -> str:
    """The `jointplay` command; `python/test.py` says where it is."""
    return os.environ["JOINTPLAY_COMMAND"]
