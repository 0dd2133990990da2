"""How a program with types uses the package: checked by mypy and pyright, and run as a test."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import jointplay as jp


class Slides(jp.Virtualization):
    """Each socket slides along its own radius, as in `'radial'`."""

    name = "slides"
    joints = [jp.VirtualJoint("l", limb) for limb in range(3)]

    def nominal(self, platform: jp.Platform) -> NDArray[np.float64]:
        return platform.radii_m

    def sockets(self, platform: jp.Platform, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return x[:, None] * platform.directions

    def socket_velocities(self, platform: jp.Platform, x: NDArray[np.float64]) -> NDArray[np.float64]:
        velocities = np.zeros((3, 3, 2))
        for limb in range(3):
            velocities[limb, limb] = platform.directions[limb]
        return velocities


def tilt_angle(gpr: jp.Gpr) -> float:
    rods: jp.Inverse = gpr.inverse(0.3, 0.02)
    pose: jp.Forward = gpr.forward(rods.rods_m, Slides())
    same: jp.Forward = gpr.forward((0.5, 0.501, 0.502), "polar", solver="newton", metric=0.05)
    azimuth: float = same.azimuth_rad
    return pose.tilt_rad + 0 * azimuth


def tilt_angles(gpr: jp.Gpr) -> NDArray[np.float64]:
    tilts: jp.InverseMany = gpr.inverse(np.linspace(0, 1, 5), 0.02)
    out: dict[str, NDArray[np.float64]] = {"tilt_rad": np.empty(5)}
    poses: jp.ForwardMany = gpr.forward(np.array(tilts.rods_m), quantities=["tilt_rad"])
    assert poses.failed == 0 and tilts.failures() and out
    return poses.tilt_rad


def parts_of_a_study(plan: jp.study.Plan) -> list[int]:
    parts: jp.study.Parts = plan.parts("run", format="csv", threads=1)
    chunk: jp.study.Chunk = plan.chunk(0)
    schema: jp.study.Schema = plan.schema
    units: dict[str, str] = plan.units
    assert len(chunk) <= plan.samples and schema and units
    try:
        parts.gather("table.csv")
    except jp.MissingPartsError as error:
        assert error.missing <= error.parts
    return [parts.write(part) for part in parts.missing()]


def refused() -> str:
    try:
        jp.Gpr.from_toml("")
    except jp.FileError as error:
        return f"{error.line}:{error.column}"
    return ""
