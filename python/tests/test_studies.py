"""Studies in chunks and parts: every engine and every file system gives the bytes of one run."""

from __future__ import annotations

import concurrent.futures
import contextlib
import functools
import hashlib
import json
import multiprocessing
import os
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import duckdb
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.fs
import pyarrow.parquet as pq
import pytest

import jointplay as jp

STUDY = """kind = "study"
name = "robots as built"
virtualizations = ["planar"]
samples = {samples}
seed = 12
quantities = ["tilt_error_urad", "origin_x_um", "q1_mm"]

[pose]
tilt_x_deg = {{ normal = [0, 0.5] }}
tilt_y_deg = {{ uniform = [-1, 1] }}
"""
# Two parts and a short one.
SMALL = STUDY.format(samples=131_073)
# Seven parts, about a second of work of a core; the next studies are for machines that end the ones before too early.
LARGE = tuple(STUDY.format(samples=400_000 * 4**k) for k in range(4))


@functools.cache
def whole(text: str, ending: str = "parquet") -> tuple[str, dict[str, Any], bytes]:
    """Digest of the table, the summary, and the table of the command on one machine."""
    with tempfile.TemporaryDirectory() as name:
        table = Path(name, f"whole.{ending}")
        command = [os.environ["JOINTPLAY_COMMAND"], "study", "-", "--out", table, "--format", "json"]
        done = subprocess.run(command, check=True, capture_output=True, text=True, input=text)
        return digest(table), json.loads(done.stdout), table.read_bytes()


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def gathered(parts: jp.study.Parts, folder: Path) -> tuple[str, dict[str, Any]]:
    """The same of parts."""
    table = folder / f"gathered.{parts.format}"
    parts.gather(table)
    return digest(table), parts.summary()


def test_a_plan_is_its_text():
    plan = jp.study.Plan.from_toml(SMALL)
    assert (plan.name, plan.samples, plan.chunks, plan.text) == ("robots as built", 131_073, 3, SMALL)
    assert plan.columns[:4] == ("sample", "tilt_x_deg", "tilt_y_deg", "height_mm")
    assert plan.units["planar_tilt_error_urad"] == "urad" and "sample" not in plan.units
    again = pickle.loads(pickle.dumps(plan))
    assert again == plan and hash(again) == hash(plan) and again.digest == plan.digest
    # Comments and names change no number.
    assert jp.study.Plan.from_toml("# mine\n" + SMALL.replace("robots", "my robots")) == plan
    assert jp.study.Plan.from_toml(SMALL.replace("seed = 12", "seed = 13")) != plan
    assert [jp.study.Plan.example(name).samples for name in ("center-shift", "tolerances")] == [2232, 10_000]
    with pytest.raises(jp.UnknownNameError, match="tolerances"):
        jp.study.Plan.example("tolerences")  # type: ignore[arg-type]
    with pytest.raises(jp.FileError, match="seed"):
        jp.study.Plan.from_toml(SMALL.replace("seed = 12", "seed = -1"))


def test_a_mechanism_is_studied():
    plan = jp.study.Plan.example("slider-crank")
    table = pa.table(plan.chunk(0))
    assert table.num_rows == plan.samples == 219
    assert set(table["status"].to_pylist()) == {"solved"}
    home = [i for i, angle in enumerate(table["main bearing_deg"].to_pylist()) if angle == 0]
    assert [table["cylinder_mm"][i].as_py() for i in home] == [0.0, 0.0, 0.0]
    assert pa.table(pickle.loads(pickle.dumps(plan)).chunk(0)) == table


def test_a_cell_is_studied():
    example = jp.study.Plan.example("station-positions")
    assert example.samples == 9 and "cycle_time_s" in example.columns
    # Two of the places: that of the file, and one out of reach.
    text = example.text.replace("dx_mm = [-100, 0, 100]", "dx_mm = 0").replace("dy_mm = [-100, 0, 400]", "dy_mm = [0, 400]")
    plan = jp.study.Plan.from_toml(text)
    table = pa.table(plan.chunk(0))
    assert table["ALIGN_dy_mm"].to_pylist() == [0.0, 400.0]
    (there, away) = table.select(["status", "cycle_time_s", "min_distance_mm"]).to_pylist()
    assert there["status"] == "passed" and there["cycle_time_s"] > 0 and there["min_distance_mm"] > 0
    assert away["status"] != "passed" and not away["cycle_time_s"] > 0
    again = jp.study.Plan.example("station-positions")
    assert pickle.loads(pickle.dumps(again)) == example != plan


def test_a_robot_file_is_pickled_with_its_plan(tmp_path):
    robot = Path(__file__).resolve().parents[2] / "crates/jointplay-format/robots" / "gpr.toml"
    (tmp_path / "mine.toml").write_text(robot.read_text().replace("height_mm = 500.0", "height_mm = 400.0"))
    (tmp_path / "s.toml").write_text(SMALL.replace("seed", 'robot = "mine.toml"\nseed'))
    plan = jp.study.Plan.from_file(tmp_path / "s.toml")
    text = pickle.dumps(plan)
    (tmp_path / "mine.toml").unlink()
    assert pickle.loads(text).digest == plan.digest
    table = pa.table(pickle.loads(text).chunk(2))
    assert table["height_mm"].to_pylist() == [400.0]
    with pytest.raises(jp.FileError, match="cannot read the file"):
        jp.study.Plan.from_file(tmp_path / "s.toml")
    with pytest.raises(jp.FileError, match="not in the catalogue"):
        jp.study.Plan.from_toml((tmp_path / "s.toml").read_text())


def test_chunks_are_the_rows_of_the_table():
    plan = jp.study.Plan.from_toml(SMALL)
    table = pq.read_table(pa.BufferReader(whole(SMALL)[2]))
    chunks = [pa.table(plan.chunk(number, threads=1 + number)) for number in range(3)]
    assert pa.concat_tables(chunks).equals(table.cast(pa.schema(plan.schema)))
    assert [len(plan.chunk(2)), plan.chunk(2).__repr__()] == [1, "Chunk(1 samples, 8 columns)"]
    # Units are in the metadata of the columns, here and in the file.
    for schema in (pa.schema(plan.schema), chunks[0].schema, table.schema):
        units = {field.name: (field.metadata or {}).get(b"unit") for field in schema}
        assert {name: unit.decode() for name, unit in units.items() if unit} == plan.units
    for number in (-1, 3, 1.5, 10**40, None, "0"):
        with pytest.raises(jp.InputError, match="there is no chunk"):
            plan.chunk(number)  # type: ignore[arg-type]
    with pytest.raises(jp.InputError, match="threads"):
        plan.chunk(0, threads=0)


def test_a_chunk_is_computed_without_the_gil():
    plan = jp.study.Plan.from_toml(SMALL)
    done = threading.Event()
    counts: list[int] = []

    def compute() -> None:
        plan.chunk(0, threads=1)
        done.set()

    thread = threading.Thread(target=compute)
    start = time.process_time()
    thread.start()
    count = 0
    while not done.is_set():
        count += 1
    thread.join()
    counts.append(count)
    # Both threads used a processor, or this one had its turn all the while.
    assert time.process_time() > start and counts[0] > 1000


def arrow_local(folder: Path) -> dict[str, Any]:
    (folder / "arrow").mkdir()
    return {"location": str(folder / "arrow" / "run"), "filesystem": pyarrow.fs.LocalFileSystem()}


LOCATIONS = {
    "local": lambda folder: {"location": folder / "run"},
    "file": lambda folder: {"location": f"file://{folder}/run"},
    "memory": lambda folder: {"location": f"memory://{folder.name}/run"},
    "arrow": arrow_local,
}


@pytest.mark.parametrize(("kind", "format"), [*((kind, "parquet") for kind in LOCATIONS), ("local", "csv")])
def test_any_file_system_has_the_parts(kind, format, tmp_path):
    plan = jp.study.Plan.from_toml(SMALL)
    options = LOCATIONS[kind](tmp_path)
    parts = plan.parts(**options, format=format)
    assert parts.missing() == [0, 1, 2] and parts.status()["done"] == 0
    # In any order, and twice.
    assert [parts.write(part) for part in (2, 0, 2)] == [2, 0, 2]
    assert parts.missing() == [1] and parts.status()["missing_ranges"] == [[1, 1]]
    for call in (parts.summary, lambda: parts.gather(tmp_path / f"t.{format}")):
        with pytest.raises(jp.MissingPartsError, match="1 of 3 parts are missing, the first is part 1") as caught:
            call()
        assert (caught.value.missing, caught.value.parts, caught.value.first) == (1, 3, 1)
    # From elsewhere.
    again = pickle.loads(pickle.dumps(parts))
    assert again == parts and again.write(1) == 1 and again.missing() == []
    assert gathered(parts, tmp_path) == whole(SMALL, format)[:2]
    names = parts._store.names()
    expected = {"study.json"} | {f"part-{part:06}.{end}" for part in range(3) for end in (format, "json")}
    assert names == expected
    with pytest.raises(jp.PartsError, match="seed: 12 in the study that was started, 13 in this file"):
        jp.study.Plan.from_toml(SMALL.replace("seed = 12", "seed = 13")).parts(**options, format=format).write(0)
    other = "csv" if format == "parquet" else "parquet"
    with pytest.raises(jp.PartsError, match=f"the parts are {format} tables"):
        plan.parts(**options, format=other).missing()  # type: ignore[arg-type]
    # A part that changed is refused, and computed again once its record is deleted.
    parts._store.write(f"part-000001.{format}", b"PAR1")
    with pytest.raises(jp.PartsError, match="delete part-000001.json, and the part is computed again"):
        parts.gather(tmp_path / f"t.{format}")
    assert not (tmp_path / f"t.{format}").exists()


def test_command_and_package_share_a_folder(tmp_path):
    plan = jp.study.Plan.from_toml(SMALL)
    parts = plan.parts(tmp_path / "run")
    parts.write(1)
    (tmp_path / "s.toml").write_text(SMALL)
    command = [os.environ["JOINTPLAY_COMMAND"], "study", "--parts", tmp_path / "run", "--quiet", "--format", "json"]
    report = subprocess.run(command, check=True, capture_output=True, text=True)
    assert json.loads(report.stdout)["computed"] == 2
    assert parts.missing() == [] and gathered(parts, tmp_path) == whole(SMALL)[:2]


def test_a_table_that_cannot_be_written_is_refused_by_its_own_name(tmp_path):
    parts = jp.study.Plan.from_toml(SMALL).parts(tmp_path / "run", format="csv")
    for part in parts.missing():
        parts.write(part)
    (tmp_path / "table.csv").mkdir()
    for path in (tmp_path / "none" / "table.csv", tmp_path / "table.csv", tmp_path / "run" / "study.json" / "table.csv"):
        with pytest.raises(OSError) as error:
            parts.gather(path)
        assert error.value.filename == str(path)
        assert "partial" not in str(error.value)
    assert {entry.name for entry in tmp_path.iterdir()} == {"run", "table.csv"}


def test_invalid_folders_are_refused(tmp_path):
    plan = jp.study.Plan.from_toml(SMALL)
    with pytest.raises(jp.UnknownNameError, match="parquet"):
        plan.parts(tmp_path, format="arrow")  # type: ignore[arg-type]
    with pytest.raises(jp.InputError, match="threads"):
        plan.parts(tmp_path, threads=-1)
    with pytest.raises(jp.InputError, match="storage_options"):
        plan.parts(tmp_path, storage_options={"key": "value"})
    (tmp_path / "study.json").write_text("[]")
    with pytest.raises(jp.PartsError, match="study.json was not written by jointplay"):
        plan.parts(tmp_path).write(0)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError):
        plan.parts(tmp_path / "file").write(0)


def kill_one(parts: jp.study.Parts, pids: list[int], futures: Sequence[Any], after: int) -> bool:
    """Kills a process once so many parts are finished; false if all work ended before."""
    while parts.status()["done"] < after and not all(future.done() for future in futures):
        time.sleep(0.01)
    os.kill(pids[0], signal.SIGKILL)
    return not all(future.done() for future in futures)


def killed_and_replaced(text: str, folder: Path) -> bool:
    """Writes parts by processes of which one is killed, and then the missing ones; false if none is missing."""
    parts = jp.study.Plan.from_toml(text).parts(folder / "run")
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        futures = [pool.submit(parts.write, part) for part in parts.missing()]
        if not kill_one(parts, list(pool._processes or {}), futures, after=2):
            return False
        # The pool ends with its process, unless that was idle and the others ended before this was noticed.
        with contextlib.suppress(concurrent.futures.process.BrokenProcessPool):
            for future in futures:
                future.result()
    if not parts.missing():
        return False
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        list(pool.map(parts.write, parts.missing()))
    assert gathered(parts, folder) == whole(text)[:2]
    return True


def until_disturbed(attempt: Callable[[str, Path], bool], folder: Path) -> None:
    """Repeats an attempt with larger studies until the work has not ended before it is disturbed."""
    assert any(attempt(text, folder / str(k)) for k, text in enumerate(LARGE)), "all work ended before it was disturbed"


@pytest.mark.once
@pytest.mark.skipif(os.name == "nt", reason="processes of Windows have no SIGKILL")
def test_processes_that_are_killed_are_made_up_for(tmp_path):
    until_disturbed(killed_and_replaced, tmp_path)


@pytest.mark.once
@pytest.mark.skipif(os.name == "nt", reason="processes of Windows have no SIGKILL")
@pytest.mark.filterwarnings("default")
def test_dask_with_a_worker_killed(tmp_path):
    until_disturbed(worker_killed, tmp_path)


def worker_killed(text: str, folder: Path) -> bool:
    """Writes parts by Dask while one of its processes is killed; false if all work ended before."""
    import dask
    from distributed import Client, LocalCluster

    plan = jp.study.Plan.from_toml(text)
    parts = plan.parts(folder / "run")
    settings = {"distributed.scheduler.allowed-failures": 10, "temporary-directory": str(folder)}
    with contextlib.ExitStack() as stack:
        stack.enter_context(dask.config.set(settings))
        cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50)
        client = stack.enter_context(Client(stack.enter_context(cluster)))
        pids = list(client.run(os.getpid).values())
        futures = client.map(parts.write, parts.missing(), pure=False, retries=3)
        if not kill_one(parts, pids, futures, after=2):
            return False
        assert sorted(client.gather(futures)) == list(range(plan.chunks))
        assert pids[0] not in client.run(os.getpid).values()
    assert gathered(parts, folder) == whole(text)[:2]
    return True

@pytest.mark.once
@pytest.mark.skipif(os.name == "nt", reason="processes of Windows have no SIGKILL")
@pytest.mark.filterwarnings("default")
def test_a_study_killed_on_dask_and_resumed_as_an_array_is_one_process(tmp_path):
    until_disturbed(killed_resumed_and_gathered, tmp_path)


def killed_resumed_and_gathered(text: str, folder: Path) -> bool:
    """Starts a study on Dask, kills all of it, resumes it as the tasks of an array job, and gathers a copy elsewhere; false if all work ended before."""
    run, study = folder / "run", folder / "study.toml"
    run.mkdir(parents=True)
    study.write_text(text)
    program = folder / "on_dask.py"
    program.write_text(ON_DASK)
    # The scheduler, the client and the workers are one group of processes.
    engine = subprocess.Popen([sys.executable, program, study, run, folder], start_new_session=True)
    parts = jp.study.Plan.from_toml(text).parts(run)
    try:
        while parts.status()["done"] < 2 and engine.poll() is None:
            time.sleep(0.01)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(engine.pid, signal.SIGKILL)
        engine.wait()
    found = {path.name: path.stat().st_mtime_ns for path in run.glob("part-*.json")}
    if not parts.missing():
        return False
    assert found, "Dask ended without a part"

    # As `sbatch --array=0-3 --wrap 'jointplay study … --part $SLURM_ARRAY_TASK_ID/4'` starts them, each by itself.
    command = os.environ["JOINTPLAY_COMMAND"]
    tasks = []
    for task in range(4):
        line = 'exec "$0" study "$1" --parts "$2" --part "$SLURM_ARRAY_TASK_ID/4" --threads 1 --quiet'
        environment = {**os.environ, "SLURM_ARRAY_TASK_ID": str(task)}
        tasks.append(subprocess.Popen(["sh", "-c", line, command, study, run], env=environment))
    assert [task.wait() for task in tasks] == [0] * 4
    assert parts.missing() == []
    # Parts of Dask were not computed again.
    assert found == {name: (run / name).stat().st_mtime_ns for name in found}

    laptop = folder / "laptop"
    shutil.copytree(run, laptop)
    shutil.rmtree(run)
    table = folder / "table.parquet"
    gather = [command, "study", "--parts", laptop, "--gather", table, "--format", "json"]
    summary = subprocess.run(gather, check=True, capture_output=True, text=True).stdout
    assert (digest(table), json.loads(summary)) == whole(text)[:2]
    return True


ON_DASK = """import sys
import dask, jointplay as jp
from distributed import Client, LocalCluster

if __name__ == "__main__":
    study, run, temporary = sys.argv[1:]
    parts = jp.study.Plan.from_file(study).parts(run)
    with dask.config.set({"temporary-directory": temporary}):
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster:
            with Client(cluster) as client:
                client.gather(client.map(parts.write, parts.missing(), pure=False))
"""


def test_statistics_in_footers_are_those_of_the_columns(tmp_path):
    # Tilts of which some turn the platform over: their poses have no numbers.
    far = SMALL.replace("normal = [0, 0.5]", "normal = [0, 40]").replace('"q1_mm"', '"q1_mm", "iterations"')
    study, table = tmp_path / "s.toml", tmp_path / "t.parquet"
    study.write_text(far)
    command = [os.environ["JOINTPLAY_COMMAND"], "study", study, "--out", table, "--quiet"]
    subprocess.run(command, check=True, capture_output=True)
    stated = duckdb.sql(f"""
        select row_group_id, path_in_schema, num_values, stats_null_count, stats_min_value, stats_max_value
        from parquet_metadata('{table}')""").fetchall()
    # Another reader than that of the footers.
    file = pq.ParquetFile(table)
    assert len(stated) == file.num_row_groups * len(file.schema_arrow) and file.num_row_groups == 3
    without_numbers = 0
    for group, name, count, nulls, least, largest in stated:
        column = file.read_row_group(group, columns=[name]).column(0)
        assert (count, nulls) == (len(column), column.null_count), name
        if pa.types.is_floating(column.type):
            numbers = column.filter(pc.is_finite(column))
            without_numbers += len(column) - len(numbers)
            expected = pc.min_max(numbers).as_py()
            assert (float(least), float(largest)) == (expected["min"], expected["max"]), name
        else:
            expected = pc.min_max(column).as_py()
            assert (least, largest) == (str(expected["min"]), str(expected["max"])), name
    assert without_numbers > 0
