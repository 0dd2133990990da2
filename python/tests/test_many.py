"""Many poses: shapes, memory, threads, what has no answer."""

from __future__ import annotations

import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest

import jointplay as jp


@pytest.fixture
def gpr() -> jp.Gpr:
    """The paper's robot, which also answers beyond its limits, as the paper's study needs."""
    return jp.Gpr.paper().without_limit_checks()

SCALARS = ("azimuth_rad", "tilt_rad", "torsion_rad", "axis_height_m", "residual_m")
VECTORS = ("origin_m", "normal", "sides_m", "virtual_joints")


@pytest.mark.parametrize("virtualization", ["radial", "polar", "offset", "planar"])
def test_each_row_is_what_one_pose_says(gpr, rods, virtualization):
    many = gpr.forward(rods, virtualization)
    assert many.failed == 0 and many.failures() == "all 300 poses have an answer"
    assert many.status.dtype == np.uint8 and not many.status.any()
    for i in (0, 1, 150, 299):
        one = gpr.forward(rods[i], virtualization)
        assert one.virtual_joint_names == many.virtual_joint_names
        # Those of the polar model, which has no closed form, are interpolated without iterations.
        assert many.iterations[i] == (0 if virtualization == "polar" else one.iterations)
        for name in SCALARS:
            assert getattr(many, name)[i] == pytest.approx(getattr(one, name), rel=1e-12, abs=1e-13)
        for name in VECTORS:
            np.testing.assert_allclose(getattr(many, name)[i], getattr(one, name), rtol=1e-12, atol=1e-13)
    nominal = gpr.forward((0.5, 0.5, 0.5), virtualization).virtual_joints
    weights = [1 if name.endswith("_m") else 1e-3 for name in many.virtual_joint_names]
    away = np.linalg.norm((many.virtual_joints - nominal) * weights, axis=-1)
    np.testing.assert_allclose(many.displacement_m, away, rtol=1e-6, atol=1e-12)


def test_only_what_is_asked_for_is_there(gpr, rods):
    some = gpr.forward(rods, quantities=["sensitivity", "azimuth_rad"])
    assert some.quantities == ("azimuth_rad", "sensitivity") and some.sensitivity.shape == (300, 3)
    np.testing.assert_array_equal(some.azimuth_rad, gpr.forward(rods).azimuth_rad)
    np.testing.assert_array_equal(some.azimuth_rad, gpr.forward(rods, quantities="azimuth_rad").azimuth_rad)
    with pytest.raises(AttributeError, match="tilt_rad was not asked for: quantities are azimuth_rad, sensitivity"):
        some.tilt_rad
    with pytest.raises(AttributeError, match="no attribute 'azimuth'"):
        some.azimuth
    assert "sensitivity" not in gpr.forward(rods).quantities
    with pytest.raises(AttributeError, match="do not change"):
        some.azimuth_rad = 3


@pytest.mark.parametrize("shape", [(1,), (0,), (7,), (4, 5), (2, 3, 4), (3, 0)])
def test_shapes(gpr, shape):
    rods = np.random.default_rng(1).uniform(0.499, 0.501, (*shape, 3))
    many = gpr.forward(rods)
    assert many.azimuth_rad.shape == many.status.shape == shape
    assert many.origin_m.shape == (*shape, 3) and many.virtual_joints.shape == (*shape, 6)
    for index in list(np.ndindex(shape))[:5]:
        np.testing.assert_allclose(many.origin_m[index], gpr.forward(rods[index]).origin_m, atol=1e-13)
    for name in ("origin_m", "virtual_joints"):
        assert all(getattr(many, name)[..., k].flags.c_contiguous for k in range(3))


@pytest.mark.parametrize(
    "arranged",
    [
        lambda a: np.asfortranarray(a),
        lambda a: np.repeat(a, 2, axis=0)[::2],
        lambda a: np.hstack([a, a])[:, :3],
        lambda a: a[::-1][::-1].copy()[::-1][::-1],
        lambda a: np.flip(np.flip(a, 1).copy(), 1),
        lambda a: a.astype(">f8"),
        lambda a: np.frombuffer(b"\0" + a.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(a.shape),
        lambda a: a.tolist(),
    ],
    ids=["fortran", "rows", "columns", "twice backwards", "backwards", "bytes", "unaligned", "list"],
)
def test_any_layout_of_memory_is_read(gpr, rods, arranged):
    expected = gpr.forward(rods, "polar")
    assert gpr.forward(arranged(rods), "polar") == expected


def test_tilts_broadcast(gpr):
    azimuth, tilt = np.linspace(-3, 3, 5)[:, None], np.linspace(0.001, 0.03, 4)
    many = gpr.inverse(azimuth, tilt, 0.51)
    assert many.rods_m.shape == (5, 4, 3) and many.failed == 0
    for i in range(5):
        for j in range(4):
            np.testing.assert_allclose(
                many.rods_m[i, j], gpr.inverse(azimuth[i, 0], tilt[j], 0.51).rods_m, rtol=1e-13
            )
    back = gpr.forward(many.rods_m, quantities=("azimuth_rad", "tilt_rad", "axis_height_m"))
    np.testing.assert_allclose(back.azimuth_rad, np.broadcast_to(azimuth, (5, 4)), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(back.tilt_rad, np.broadcast_to(tilt, (5, 4)), rtol=1e-9)
    np.testing.assert_allclose(back.axis_height_m, 0.51, rtol=1e-13)
    with pytest.raises(jp.ArrayError, match=r"azimuth_rad \(2,\), tilt_rad \(3,\), height_m \(\)"):
        gpr.inverse([0, 1], [0, 0.01, 0.02])
    assert gpr.inverse(np.zeros((0, 2)), 0.01).rods_m.shape == (0, 2, 3)


def test_results_are_written_in_place(gpr, rods):
    expected = gpr.forward(rods)
    out = {"azimuth_rad": np.empty(300), "origin_m": np.empty((300, 3), order="F")}
    many = gpr.forward(rods, out=out)
    assert many.quantities == ("azimuth_rad", "origin_m")
    assert many.origin_m is out["origin_m"] and many.azimuth_rad is out["azimuth_rad"]
    np.testing.assert_array_equal(out["origin_m"], expected.origin_m)
    wide = np.full((300, 8), 7.0, order="F")
    gpr.forward(rods, out={"normal": wide[:, 2:5]})
    np.testing.assert_array_equal(wide[:, 2:5], expected.normal)
    assert (wide[:, :2] == 7).all() and (wide[:, 5:] == 7).all()
    again = np.empty((300, 3), order="F")
    back = gpr.inverse(expected.azimuth_rad, expected.tilt_rad, expected.axis_height_m, out=again)
    assert back.rods_m is again
    np.testing.assert_allclose(again, rods, rtol=1e-12)
    both = gpr.forward(rods, quantities=["azimuth_rad", "tilt_rad"], out={"azimuth_rad": out["azimuth_rad"]})
    assert both.azimuth_rad is out["azimuth_rad"] and both.quantities == ("azimuth_rad", "tilt_rad")
    one = gpr.forward(rods[0], out={"azimuth_rad": np.empty(())})
    assert one.azimuth_rad.shape == () and one.azimuth_rad == expected.azimuth_rad[0]


def read_only(array):
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    ("out", "kind", "message"),
    [
        ({"azimuth_rad": np.empty(299)}, jp.ArrayError, r"of shape \(300,\), not \(299,\)"),
        ({"origin_m": np.empty(300)}, jp.ArrayError, r"of shape \(300, 3\)"),
        ({"azimuth_rad": np.empty(300, dtype=np.float32)}, jp.ArrayTypeError, "dtype float32"),
        ({"azimuth_rad": np.empty(300, dtype=">f8")}, jp.ArrayTypeError, "dtype >f8"),
        ({"azimuth_rad": [0.0] * 300}, jp.ArrayTypeError, "list"),
        ({"origin_m": np.empty((300, 3))}, jp.ArrayError, 'order="F"'),
        ({"azimuth_rad": np.empty(600)[::2]}, jp.ArrayError, "one piece"),
        ({"azimuth_rad": read_only(np.empty(300))}, jp.ArrayError, "read-only"),
        ({"azimuth_deg": np.empty(300)}, jp.UnknownNameError, "did you mean `azimuth_rad`"),
    ],
)
def test_arrays_that_cannot_be_written(gpr, rods, out, kind, message):
    with pytest.raises(kind, match=message):
        gpr.forward(rods, out=out)


def test_arrays_that_overlap_are_refused(gpr):
    memory = np.full((50, 4), 0.5, order="F")
    with pytest.raises(jp.ArrayError, match="shares memory"):
        gpr.forward(memory[:, :3].copy(), out={"origin_m": memory[:, :3], "azimuth_rad": memory[:, 2]})
    with pytest.raises(jp.ArrayError, match="shares memory"):
        gpr.forward(memory[:, :3], out={"azimuth_rad": memory[:, 0]})
    assert (memory == 0.5).all()
    # Nothing stays borrowed afterwards.
    gpr.forward(memory[:, :3], out={"azimuth_rad": memory[:, 3]})
    assert (memory[:, 3] == 0).all()


def test_rows_without_an_answer(gpr, rods):
    rods[3, 1] = np.nan
    rods[5] = (0.2, 0.5, 0.9)
    many = gpr.forward(rods, "offset", solver="newton")
    assert many.status[3] == jp.Status.NOT_FINITE and many.status[5] == jp.Status.NOT_CONVERGED
    assert many.failed == 2 and dict(many.failure_counts) == {"not a finite number": 1, "not converged": 1}
    assert many.failures() == "2 of 300 poses have no answer: 1 not a finite number, 1 not converged"
    for name in many.quantities:
        assert np.isnan(getattr(many, name)[[3, 5]]).all()
        assert np.isfinite(np.delete(getattr(many, name), [3, 5], axis=0)).all()
    tilts = gpr.inverse([0, 0, np.nan], [0.01, 2, 0.01])
    assert tilts.status.tolist() == [0, jp.Status.TILT_TOO_LARGE, jp.Status.NOT_FINITE]
    assert np.isnan(tilts.rods_m[1:]).all() and np.isfinite(tilts.rods_m[0]).all()


def test_threads_change_no_bit(gpr):
    rods = np.random.default_rng(3).uniform(0.49, 0.51, (20_000, 3))
    expected = gpr.forward(rods, "offset", threads=1)
    for threads in (None, 2, 3, 7):
        assert gpr.forward(rods, "offset", threads=threads) == expected
        assert gpr.inverse(expected.azimuth_rad, expected.tilt_rad, threads=threads) == gpr.inverse(
            expected.azimuth_rad, expected.tilt_rad, threads=1
        )
    for threads in (0, -1, 5000):
        with pytest.raises(jp.InputError, match="number from 1 to 1024"):
            gpr.forward(rods, threads=threads)


def seen_under_way(gpr, poses):
    """Whether another thread has seen the first of these poses computed and the last not yet."""
    rods = np.broadcast_to((0.5, 0.501, 0.502), (poses, 3))
    out = {"azimuth_rad": np.full(poses, -7.0)}
    done, seen = threading.Event(), threading.Event()

    def watch():
        while not (done.is_set() or seen.is_set()):
            first, last = out["azimuth_rad"][0], out["azimuth_rad"][-1]
            if first != -7.0 and last == -7.0:
                seen.set()
            time.sleep(1e-4)

    watcher = threading.Thread(target=watch)
    watcher.start()
    gpr.forward(rods, "polar", solver="least-norm", out=out, threads=1)
    done.set()
    watcher.join()
    assert out["azimuth_rad"][-1] != -7.0
    return seen.is_set()


# Numbers of poses; the larger ones are for machines on which few poses take too little time.
LENGTHS = (1_000_000, 4_000_000, 16_000_000, 64_000_000)


def test_other_threads_go_on_meanwhile(gpr):
    assert any(seen_under_way(gpr, poses) for poses in LENGTHS)


def test_a_forked_process_has_threads_of_its_own(gpr):
    import multiprocessing
    import sys

    if sys.platform != "linux":
        return
    rods = np.random.default_rng(3).uniform(0.49, 0.51, (20_000, 3))
    expected = gpr.forward(rods, threads=2)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.apply_async(forward, (gpr, rods)).get(60) == expected


def forward(gpr, rods):
    return gpr.forward(rods, threads=2)


def test_memory_does_not_grow(gpr):
    resource = pytest.importorskip("resource")
    rods = np.random.default_rng(3).uniform(0.49, 0.51, (50_000, 3))

    def work(times):
        for _ in range(times):
            many = gpr.forward(rods, threads=2)
            gpr.inverse(many.azimuth_rad, many.tilt_rad)
            many.to_dataframe()
            for _ in range(500):
                gpr.forward((0.5, 0.501, 0.502)).origin_m

    work(10)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    work(40)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    # One set of results is 10 MB; forty that were kept would be 400.
    assert grown < 40_000, f"{grown} kB"


def test_results_are_values(gpr, rods):
    rods[3, 1] = np.nan
    for many in (gpr.forward(rods, "polar"), gpr.inverse(np.zeros(4), np.full(4, 0.01))):
        assert pickle.loads(pickle.dumps(many)) == many
        assert len(repr(many)) < 300
    assert gpr.forward(rods, "polar") != gpr.forward(rods, "offset")
    with pytest.raises(TypeError):
        hash(gpr.forward(rods))


def test_data_frames(gpr, rods):
    import pandas
    import polars
    import pyarrow

    rods[3, 1] = np.nan
    for many in (gpr.forward(rods.reshape(100, 3, 3), "polar"), gpr.inverse(np.zeros(4), np.full(4, 0.01))):
        frame = many.to_dataframe()
        assert isinstance(frame, pandas.DataFrame)
        others = {
            "pyarrow": pyarrow.table(many).to_pandas(),
            "polars": pandas.DataFrame(polars.DataFrame(many).to_dict(as_series=False)),
        }
        for name, other in others.items():
            pandas.testing.assert_frame_equal(
                frame, other, check_exact=True, check_dtype=name == "pyarrow"
            )
    frame = gpr.forward(rods, "polar").to_dataframe()
    assert list(frame.columns[4:10]) == [
        "origin_x_m", "origin_y_m", "origin_z_m", "normal_x", "normal_y", "normal_z",
    ]
    assert "phi_2_rad" in frame.columns and "l_3_m" in frame.columns
    assert frame.status[3] == 1 and frame.origin_x_m[7] == gpr.forward(rods, "polar").origin_m[7, 0]


def interrupted(gpr, poses):
    """Interrupts a call with these poses once the first one is computed; whether that was before the last one."""
    rods = np.broadcast_to((0.5, 0.501, 0.502), (poses, 3))
    out = {"azimuth_rad": np.full(poses, -7.0)}

    def interrupt():
        # As soon as the first poses are there; a minute for machines that are busy.
        patience = time.monotonic() + 60
        while out["azimuth_rad"][0] == -7.0 and time.monotonic() < patience:
            time.sleep(0.001)
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        threading.Thread(target=interrupt).start()
        gpr.forward(rods, "polar", solver="least-norm", out=out, threads=1)
        # Where it has ended before, the interruption is still to come.
        time.sleep(120)
    assert out["azimuth_rad"][0] != -7.0
    return out["azimuth_rad"][-1] == -7.0


@pytest.mark.skipif(os.name == "nt", reason="signals to oneself are of Unix")
def test_interrupt_stops_long_work(gpr):
    # Processes in the background of a shell are born deaf to it.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        assert any(interrupted(gpr, poses) for poses in LENGTHS)
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(os.name == "nt", reason="signals to oneself are of Unix")
def test_interrupt_ends_a_long_drive():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    four_bar = jp.Mechanism.from_catalogue("four-bar")
    try:
        with pytest.raises(KeyboardInterrupt):
            threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
            four_bar.drive({"A": (0, 1e6)}, steps=1)
            # Where it has ended before, the interruption is still to come.
            time.sleep(120)
    finally:
        signal.signal(signal.SIGINT, before)
