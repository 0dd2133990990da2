"""The same study on several engines: every one gives the bytes of a run on one machine.

    python3 validation/engines.py path/to/jointplay [--only slurm,chain,s3,ray,processors,kubernetes]

For developers who change studies in parts; too slow, and with too many packages, for `cargo xtask test`, which runs Dask and processes.
It prints one line for each engine, with the SHA-256 of the gathered table and the time, and fails if one differs.

`slurm`      an array of eight tasks on a Slurm of this machine: Debian's slurmctld, slurmd, slurm-client and munge, as root
`chain`      begun on Dask, killed with all its processes, resumed on Slurm, and gathered from a copy of the folder: package distributed
`s3`         processes that write to an object store by s3fs: packages fsspec, s3fs and moto[server]
`ray`        tasks of Ray: package ray
`processors` the command on processors without AVX and with AVX2, emulated by qemu-x86_64, and on aarch64
             by qemu-aarch64 if `JOINTPLAY_AARCH64` names a command for it
`kubernetes` the manifest of the documentation by its schema, and the arguments of its container: package kubernetes-validate

`chain`, `s3` and `ray` need the Python package jointplay, of the same version as the command.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import contextlib
import hashlib
import json
import multiprocessing
import os
import pwd
import re
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

STUDY = """kind = "study"
name = "engines"
virtualizations = ["planar", "polar"]
samples = 4_800_000
seed = 5
quantities = ["tilt_error_urad", "origin_x_um", "q1_mm"]

[pose]
tilt_x_deg = { normal = [0, 0.5] }
tilt_y_deg = { uniform = [-1, 1] }
"""
"""74 parts."""

EVERYTHING = """kind = "study"
virtualizations = ["planar", "polar", "radial", "offset"]
solver = "{solver}"
samples = 600
seed = 3
quantities = ["rods_mm", "sides_mm", "dimensions", "origin_x_mm", "origin_y_mm", "origin_z_mm", "center_shift_um",
  "axis_height_mm", "azimuth_deg", "tilt_deg", "tilt_x_deg", "tilt_y_deg", "tilt_error_urad", "torsion_deg", "normal_x",
  "normal_y", "normal_z", "displacement_um", "ball_displacements_um", "virtual_joints", "sensitivity_1", "sensitivity_2", "sensitivity_3",
  "residual_mm", "iterations"]

[pose]
tilt_x_deg = {{ normal = [0, 15] }}
tilt_y_deg = {{ normal = [0, 15] }}
height_mm = {{ uniform = [350, 650] }}

[tolerances]
socket_radius_mm = {{ normal = [0, 0.01] }}
socket_angle_deg = {{ uniform = [-0.02, 0.02] }}
base_x_mm = {{ normal = [0, 0.02] }}
base_y_mm = {{ normal = [0, 0.02] }}
"""
"""Every quantity."""


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def run(*command: object) -> str:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"failed: {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def until(condition, seconds: float, what: str) -> None:
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"after {seconds:.0f} s: {what}")
        time.sleep(0.02)


class Daemons:
    """Processes in the background, ended by their own identifiers."""

    def __init__(self) -> None:
        self.processes: list[subprocess.Popen[bytes]] = []

    def start(self, log: Path, *command: object, **options: object) -> None:
        with open(log, "wb") as file:
            process = subprocess.Popen([str(part) for part in command], stdout=file, stderr=file, **options)  # type: ignore[call-overload]
        self.processes.append(process)

    def __enter__(self) -> Daemons:
        return self

    def __exit__(self, *_: object) -> None:
        for process in reversed(self.processes):
            process.send_signal(signal.SIGTERM)
        for process in reversed(self.processes):
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


@contextlib.contextmanager
def slurm_at(place: Path) -> Iterator[Callable[..., str]]:
    """A Slurm of this machine alone with its files in a new folder; a function that runs its commands."""
    munge = pwd.getpwnam("munge")
    place.mkdir()
    os.chmod(place.parent, 0o755)
    secret = place / "munge"
    secret.mkdir(mode=0o755)
    (secret / "key").write_bytes(secrets.token_bytes(1024))
    for path in (secret, secret / "key"):
        os.chown(path, munge.pw_uid, munge.pw_gid)
    os.chmod(secret / "key", 0o400)
    for name in ("state", "spool"):
        (place / name).mkdir()
    host, cores = socket.gethostname().split(".")[0], os.cpu_count() or 1
    config = place / "slurm.conf"
    config.write_text(
        f"""ClusterName=loopback
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
AuthType=auth/munge
AuthInfo=socket={secret}/socket
CredType=cred/munge
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
StateSaveLocation={place}/state
SlurmdSpoolDir={place}/spool
SlurmctldPidFile={place}/slurmctld.pid
SlurmdPidFile={place}/slurmd.pid
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""
    )
    environment = {**os.environ, "SLURM_CONF": str(config)}
    with Daemons() as daemons:
        daemons.start(
            place / "munged.log",
            *("/usr/sbin/munged", "--foreground", f"--socket={secret}/socket", f"--key-file={secret}/key"),
            *(f"--pid-file={secret}/pid", f"--log-file={secret}/log", f"--seed-file={secret}/seed"),
            user=munge.pw_uid,
            group=munge.pw_gid,
        )
        until((secret / "socket").exists, 20, "munged has no socket")
        daemons.start(place / "slurmctld.log", "/usr/sbin/slurmctld", "-D", "-f", config, env=environment)
        daemons.start(place / "slurmd.log", "/usr/sbin/slurmd", "-D", "-f", config, "-N", host, env=environment)

        def ask(*words: object) -> str:
            done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False, env=environment)
            return done.stdout.strip()

        until(lambda: ask("sinfo", "-h", "-o", "%T").startswith("idle"), 60, "the node is not idle")
        yield ask


def slurm(command: Path, study: Path, folder: Path) -> Path:
    """An array job, one task of which is killed."""
    place = folder / "slurm"
    with slurm_at(place) as ask:
        task = f"{command} study {study} --parts {folder}/run --part $SLURM_ARRAY_TASK_ID/8 --threads 1"
        submitted = ["sbatch", "--parsable", "--array=0-7", "--output", place / "task-%a.log", "--wrap", task]
        job = ask(*submitted)
        if not job.isdigit():
            sys.exit(f"sbatch printed {job!r}")
        # A task killed after its first part, and submitted again.
        until((folder / "run" / "part-000003.json").exists, 60, "task 3 did not start")
        ask("scancel", "--signal=KILL", "--batch", f"{job}_3")
        until(lambda: ask("squeue", "-h", "-j", job) == "", 300, "the job has not ended")
        status = subprocess.run(
            [command, "study", "--parts", folder / "run", "--status", "--format", "json"],
            capture_output=True,
            text=True,
            check=False,
        )
        left = json.loads(status.stdout)["missing"]
        print(f"slurm: {left} parts are missing after task 3 was killed; it runs again", flush=True)
        if left == 0:
            sys.exit("task 3 was not killed in the middle")
        job = ask("sbatch", "--parsable", "--array=3", "--output", place / "again-%a.log", "--wrap", task)
        until(lambda: ask("squeue", "-h", "-j", job) == "", 300, "the job has not ended")
    table = folder / "slurm.parquet"
    run(command, "study", "--parts", folder / "run", "--gather", table)
    return table


DASK = """import sys

import jointplay as jp
from distributed import Client, LocalCluster

if __name__ == "__main__":
    parts = jp.study.Plan.from_file(sys.argv[1]).parts(sys.argv[2])
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.gather(client.map(parts.write, parts.missing(), pure=False))
"""


def chain(command: Path, study: Path, folder: Path) -> Path:
    """Begun on Dask, killed, resumed on Slurm, gathered from a copy."""
    parts, script = folder / "chain", folder / "begin.py"
    script.write_text(DASK)
    with open(folder / "dask.log", "wb") as log:
        dask = subprocess.Popen([sys.executable, script, study, parts], stdout=log, stderr=log, start_new_session=True)
    try:
        until(lambda: len(list(parts.glob("part-*.json"))) >= 5, 120, "Dask has not written five parts")
    finally:
        os.killpg(dask.pid, signal.SIGKILL)
        dask.wait()
    finished = len(list(parts.glob("part-*.json")))
    print(f"chain: {finished} parts are finished after Dask was killed; Slurm continues", flush=True)
    place = folder / "slurm-of-chain"
    with slurm_at(place) as ask:
        task = f"{command} study --parts {parts} --part $SLURM_ARRAY_TASK_ID/4 --threads 1"
        job = ask("sbatch", "--parsable", "--array=0-3", "--output", place / "task-%a.log", "--wrap", task)
        until(lambda: ask("squeue", "-h", "-j", job) == "", 300, "the job has not ended")
        logs = "".join(log.read_text() for log in sorted(place.glob("task-*.log")))
    found = sum(int(number) for number in re.findall(r"found (\d+)", logs))
    if not 0 < found == finished:
        sys.exit(f"Slurm found {found} of {finished} finished parts:\n{logs}")
    elsewhere, table = folder / "elsewhere", folder / "chain.parquet"
    shutil.copytree(parts, elsewhere)
    run(command, "study", "--parts", elsewhere, "--gather", table)
    return table


def s3(_command: Path, study: Path, folder: Path) -> Path:
    """Processes that write to an object store."""
    import fsspec
    import jointplay as jp

    port = free_port()
    endpoint = f"http://127.0.0.1:{port}"
    os.environ.update(AWS_ACCESS_KEY_ID="key", AWS_SECRET_ACCESS_KEY="secret", AWS_DEFAULT_REGION="us-east-1")
    with Daemons() as daemons:
        daemons.start(folder / "moto.log", sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", port)

        def listens() -> bool:
            with socket.socket() as probe:
                return probe.connect_ex(("127.0.0.1", port)) == 0

        until(listens, 60, "the object store does not listen")
        options = {"endpoint_url": endpoint}
        fsspec.filesystem("s3", **options).mkdir("bucket")
        parts = jp.study.Plan.from_file(study).parts("s3://bucket/run", storage_options=options)
        context = multiprocessing.get_context("spawn")
        with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
            list(pool.map(parts.write, parts.missing()))
        table = folder / "s3.parquet"
        parts.gather(table)
    return table


def ray(_command: Path, study: Path, folder: Path) -> Path:
    """Tasks of Ray, one of whose processes is killed."""
    import jointplay as jp

    import ray as engine

    parts = jp.study.Plan.from_file(study).parts(folder / "run-of-ray")
    os.environ["RAY_AUTH_MODE"] = "disabled"
    engine.init(num_cpus=2, include_dashboard=False, log_to_driver=False)

    @engine.remote(max_retries=3)
    def write(part: int) -> int:
        if part == 4 and not (folder / "killed").exists():
            (folder / "killed").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return parts.write(part)

    try:
        done = engine.get([write.remote(part) for part in parts.missing()])
    finally:
        engine.shutdown()
    assert sorted(done) == list(range(parts.plan.chunks)) and (folder / "killed").exists()
    table = folder / "ray.parquet"
    parts.gather(table)
    return table


def processors(command: Path, folder: Path) -> bool:
    """The command on emulated processors; whether all agree."""
    emulated: dict[str, list[object]] = {
        "this processor": [command],
        "x86-64 without AVX": ["qemu-x86_64", "-cpu", "Nehalem", command],
        "x86-64 with AVX2": ["qemu-x86_64", "-cpu", "Haswell", command],
    }
    if other := os.environ.get("JOINTPLAY_AARCH64"):
        emulated["aarch64"] = ["qemu-aarch64", other]
    agree = True
    for solver in ("newton", "least-norm", "closed-form"):
        study = folder / f"{solver}.toml"
        study.write_text(EVERYTHING.format(solver=solver))
        found = {}
        for k, (name, words) in enumerate(emulated.items()):
            table = folder / f"{solver}-{k}.csv"
            summary = run(*words, "study", study, "--out", table, "--threads", 1, "--format", "json")
            found[name] = (digest(table), hashlib.sha256(summary.encode()).hexdigest())
            print(f"{solver:12} {name:20} table {found[name][0][:16]} summary {found[name][1][:16]}", flush=True)
        agree &= len(set(found.values())) == 1
    return agree


def kubernetes(command: Path, study: Path, folder: Path) -> None:
    """Checks the manifest of the documentation, refuses one with a misspelled key, and runs its arguments as a task."""
    import kubernetes_validate
    import yaml

    page = Path(__file__).resolve().parents[1] / "docs" / "how-to" / "run-a-study-on-a-cluster.md"
    (text,) = re.findall(r"^```yaml\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    manifest = yaml.safe_load(text)
    version = kubernetes_validate.validate(manifest, "1.33", strict=True)
    (container,) = manifest["spec"]["template"]["spec"]["containers"]
    places = {"/study/workspace.toml": str(study), "/shared/run": str(folder / "kubernetes"), "$(JOB_COMPLETION_INDEX)": "63"}
    # The image has no shell: Kubernetes itself replaces the variable.
    words = container["args"]
    for place, here in places.items():
        words = [word.replace(place, here) for word in words]
    run(command, *words)
    if not list((folder / "kubernetes").glob("part-000063.*")):
        sys.exit(f"the arguments of the manifest compute no part: {words}")
    manifest["spec"]["completionmode"] = manifest["spec"].pop("completionMode")
    try:
        kubernetes_validate.validate(manifest, "1.33", strict=True)
    except kubernetes_validate.ValidationError:
        print(f"kubernetes   manifest valid for {version}", flush=True)
    else:
        sys.exit("the schema checker accepts an unknown key")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("command", type=Path)
    parser.add_argument("--only", default="slurm,chain,s3,ray,processors,kubernetes")
    chosen = parser.parse_args()
    command = chosen.command.resolve()
    wanted = chosen.only.split(",")
    folder = Path(tempfile.mkdtemp(prefix="jointplay-engines-"))
    agree = True
    try:
        study = folder / "study.toml"
        study.write_text(STUDY)
        start = time.monotonic()
        whole = folder / "whole.parquet"
        run(command, "study", study, "--out", whole)
        expected = digest(whole)
        print(f"{'one process':12} {expected} {time.monotonic() - start:6.1f} s", flush=True)
        for engine in (slurm, chain, s3, ray):
            if engine.__name__ not in wanted:
                continue
            start = time.monotonic()
            found = digest(engine(command, study, folder))
            print(f"{engine.__name__:12} {found} {time.monotonic() - start:6.1f} s", flush=True)
            agree &= found == expected
        if "kubernetes" in wanted:
            kubernetes(command, study, folder)
        if "processors" in wanted:
            agree &= processors(command, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    sys.exit(0 if agree else "not all are the same")


if __name__ == "__main__":
    main()
