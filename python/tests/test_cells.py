"""Work cells: plans of programs, sweeps of stations, exports, errors."""

from __future__ import annotations

import pathlib
import pickle
import threading

import numpy as np
import pytest

import jointplay as jp

SHORT = "HOME\nTRANSFER LP1 SLOT 1 TO ALIGN WITH A\n"
CELL = jp.Cell.example()
PLAN = CELL.plan(SHORT)


def test_a_plan_reports_what_the_trajectory_and_the_check_say():
    assert PLAN.passed and PLAN.violations == 0
    report = PLAN.report()
    assert report["result"] == "passed" and report["violations"] == []
    assert report["duration_s"] == pytest.approx(PLAN.duration_s, rel=1e-12)
    assert PLAN.min_distance_m is not None and 1e-4 < PLAN.min_distance_m < 5e-3
    # HOME at the home position is no motion.
    assert [row["line"] for row in report["instructions"]] == [2]


def test_samples_are_a_motion_of_all_axes():
    samples = PLAN.samples(1000.0)
    assert samples.axes == CELL.axes == ("q1", "q2", "q3", "T", "RA", "RB")
    assert samples.axis_units == ("m", "m", "m", "rad", "rad", "rad")
    assert samples.time_s[0] == 0 and samples.time_s[-1] == pytest.approx(PLAN.duration_s, abs=1e-12)
    assert samples.positions.shape == samples.velocities.shape == (samples.time_s.size, 6)
    # Central differences of the positions are the velocities, but for the third derivative.
    steps = np.diff(samples.time_s)[:-1]
    differences = (samples.positions[2:-1] - samples.positions[:-3]) / (2 * steps[1:, None])
    worst = np.abs(differences - samples.velocities[1:-2]).max(axis=0)
    assert (worst < 2e-3 * np.abs(samples.velocities).max(axis=0) + 1e-12).all(), worst
    # At rest at both ends.
    assert np.abs(samples.velocities[[0, -1]]).max() < 1e-9
    frame = samples.to_dataframe()
    assert {"time_s", "step", "line", "q1_m", "T_rad", "RA_rad_s", "RB_rad_s2"} <= set(frame.columns)
    assert len(frame) == samples.time_s.size


def test_a_table_has_the_chosen_columns_of_the_window():
    window = PLAN.table(["time", "heading", "A_tilt"], rate_hz=50.0, from_s=1.0, to_s=2.0)
    assert list(window) == ["time_s", "A_heading_deg", "B_heading_deg", "A_tilt_deg"]
    whole = PLAN.table(["all"], rate_hz=50.0)
    for name, values in window.items():
        assert len(values) == 51
        assert (values == whole[name][50:101]).all(), name
    with pytest.raises(jp.InputError, match="did you mean `heading`"):
        PLAN.table(["headings"])
    with pytest.raises(jp.InputError, match="window"):
        PLAN.table(from_s=2.0, to_s=1.0)


def test_poses_of_links_are_those_of_the_table():
    window = {"rate_hz": 50.0, "from_s": 1.0, "to_s": 2.0}
    table = PLAN.table(["time", "poses"], **window)
    for name in ("q1", "platform", "upper link 1", "lower link 4", "A"):
        poses = PLAN.link_poses(name, **window)
        assert poses.shape == (51, 4, 4)
        origins = np.stack([table[f"{name}_{axis}_mm"] for axis in "xyz"], axis=1)
        np.testing.assert_allclose(1e3 * poses[:, :3, 3], origins, rtol=0, atol=1e-9)
        w, x, y, z = (table[f"{name}_q{part}"] for part in "wxyz")
        np.testing.assert_allclose(poses[:, 2, 2], w * w - x * x - y * y + z * z, rtol=0, atol=1e-12)
        np.testing.assert_allclose(poses[:, 1, 0], 2 * (x * y + z * w), rtol=0, atol=1e-12)
        assert (poses[:, 3] == [0, 0, 0, 1]).all()
    assert table["virtual_displacement_um"].max() < 60
    with pytest.raises(jp.InputError, match="did you mean `upper link 1`"):
        PLAN.link_poses("uper link 1")


def test_a_station_elsewhere_changes_the_plan_and_keeps_the_text():
    # Along the radius of LP1: the arm extends less.
    durations = []
    for offset in (-0.02, 0.0, 0.02):
        position = np.array([-0.495, 0.495, 0.5]) * [1 + offset, 1 + offset, 1]
        moved = CELL.with_station("LP1", position_m=position)
        assert moved.text.count("#") == CELL.text.count("#")
        durations.append(moved.plan(SHORT).duration_s)
    assert durations[1] == pytest.approx(PLAN.duration_s, rel=1e-12)
    assert durations[0] < durations[1] < durations[2]
    tilted = CELL.with_station("LP1", tilt_rad=(0.5, 0.01))
    assert tilted.plan(SHORT).report()["compensated"] != PLAN.report()["compensated"]


def test_the_result_does_not_depend_on_threads_and_pickles():
    again = pickle.loads(pickle.dumps(CELL)).plan(SHORT, threads=1)
    assert again.report() == PLAN.report() == CELL.plan(SHORT, threads=2).report()
    assert (again.samples().positions == PLAN.samples().positions).all()


def test_other_threads_run_during_a_plan():
    count, done = 0, threading.Event()

    def work() -> None:
        nonlocal count
        while not done.wait(0.001):
            count += 1

    other = threading.Thread(target=work)
    other.start()
    CELL.plan("HOME\nREPEAT 4 AS n\n  TRANSFER LP1 SLOT n TO LP2 SLOT n WITH A\nEND\n")
    done.set()
    other.join()
    assert count > 5


def test_exports_refuse_violations_unless_asked(tmp_path):
    assert PLAN.gltf(rate_hz=10)[:4] == b"glTF"
    assert "LP1" in PLAN.controller_text()
    wall = CELL.text.replace("position_mm = [100.0, -600.0, 500.0]", "position_mm = [-100.0, 100.0, 700.0]")
    assert wall != CELL.text
    broken = jp.Cell.from_toml(wall).plan(SHORT)
    assert not broken.passed and broken.violations == len(broken.report()["violations"]) > 0
    with pytest.raises(jp.NoAnswerError, match="despite_errors"):
        broken.gltf()
    assert broken.gltf(rate_hz=10, despite_errors=True)[:4] == b"glTF"
    with pytest.raises(jp.UnknownNameError) as unknown:
        PLAN.controller_text("points2")
    assert unknown.value.known == ["neutral", "points"]
    file = tmp_path / "short.program"
    file.write_text(SHORT)
    assert CELL.plan(pathlib.Path(file)).duration_s == PLAN.duration_s


def test_parameters_of_a_program_are_set():
    program = "PARAMETER lot = 2 FROM 1 TO 25\nPARAMETER pause = 1 s\nREPEAT lot\n  WAIT pause s\nEND\n"
    assert CELL.plan(program).duration_s == 2
    assert CELL.plan(program, parameters={"lot": 3, "pause": "0.5 s"}).duration_s == 1.5
    for parameters, message in [
        ({"lott": 3}, "did you mean `lot`"),
        ({"lot": 26}, "from 1 to 25"),
        ({"pause": 2}, "as in `2 s`"),
    ]:
        with pytest.raises(jp.FileError, match=message):
            CELL.plan(program, parameters=parameters)
    with pytest.raises(jp.NotFiniteError):
        CELL.plan(program, parameters={"lot": float("nan")})


def test_errors_say_where_and_why(tmp_path):
    with pytest.raises(jp.FileError) as bad:
        jp.Cell.from_toml(CELL.text.replace("name = ", "naem = "))
    assert bad.value.line >= 1 and "naem" in str(bad.value)
    with pytest.raises(jp.FileError) as bad:
        CELL.plan("HOME\nGET LP9 SLOT 1 WITH A\n")
    assert (bad.value.file, bad.value.line) == ("program", 2) and "LP9" in str(bad.value)
    with pytest.raises(jp.PlanningError) as refused:
        CELL.plan("HOME\nTILT 3 deg TOWARD 20 deg\n")
    assert refused.value.reasons[0][0] == 2
    with pytest.raises(jp.UnknownNameError):
        CELL.with_station("LP9", heading_rad=0.1)
    with pytest.raises(jp.NotFiniteError):
        CELL.with_station("LP1", position_m=[0.1, float("nan"), 0.5])
    with pytest.raises(jp.InputError):
        PLAN.samples(float("nan"))
    with pytest.raises(OSError):
        jp.Cell.from_file(tmp_path / "none.toml")
    (tmp_path / "cell.toml").write_text(CELL.text.replace('robot = "dual-arm"', 'robot = "../robot.toml"'))
    with pytest.raises(jp.FileError, match="within the cell file's folder"):
        jp.Cell.from_file(tmp_path / "cell.toml")
