"""Sweeps by threads and by a Dask cluster: one journal, one result."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

import pinwheel
from pinwheel import ClusterError, Scene

distributed = pytest.importorskip("distributed")


def results(folder):
    return (folder / "results.csv").read_bytes()


@pytest.fixture
def expected(program, sweep_file, tmp_path):
    program("sweep", sweep_file.name, "--out", "program", cwd=tmp_path)
    return results(tmp_path / "program")


@pytest.fixture
def cluster(monkeypatch, tmp_path):
    monkeypatch.setenv("DASK_TEMPORARY_DIRECTORY", str(tmp_path))
    made = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with made, distributed.Client(made) as client:
        yield client


def test_threads(expected, sweep_file, tmp_path):
    sweep = pinwheel.sweep(sweep_file, jobs=2, out=tmp_path / "ours")
    assert results(tmp_path / "ours") == expected
    assert sweep["gear.backlash_m"].shape == (40,) and not sweep.unfinished
    assert np.isfinite(sweep["mean_input_torque_n_m"]).all()
    assert not (tmp_path / "ours.unfinished").exists()
    assert sweep.to_pandas().shape[0] == 40 and sweep.to_polars().height == 40
    assert "small" in sweep.page() and "<table>" in sweep._repr_html_()
    again = pinwheel.sweep(
        Scene("paper", duration_s=0.004),
        vary={"backlash_m": {"from": 0.0, "to": 3e-4, "points": 20}, "damping_n_s_m": np.array([8.0, 16.0])},
        engines=["native-reduced"],
        out=tmp_path / "scene",
    )
    assert results(again.out) == expected


def unfinished(runs, out):
    """Makes records of finished runs the journal of an interrupted sweep, which its lock marks."""
    journal = out.with_name(f"{out.name}.unfinished")
    runs.rename(journal)
    (journal / ".lock").write_text("process 1 (`pinwheel sweep`)\n")


def test_each_resumes_the_others_journal(program, expected, sweep_file, tmp_path):
    # The program's forty are taken over, with what they cost there, and so are the package's.
    unfinished(tmp_path / "program/runs", tmp_path / "a")
    first = set((tmp_path / "program/costs.csv").read_text().splitlines())
    pinwheel.sweep(sweep_file, out=tmp_path / "a", resume=True)
    assert set((tmp_path / "a/costs.csv").read_text().splitlines()) == first
    program("sweep", sweep_file.name, "--out", "a", "--resume", cwd=tmp_path)
    assert set((tmp_path / "a/costs.csv").read_text().splitlines()) == first
    assert results(tmp_path / "a") == expected


def test_a_sample_is_the_same_on_a_cluster(cluster, tmp_path):
    ask = {
        "sample": {
            "points": 48,
            "method": "sobol",
            "backlash_m": {"from": 1e-6, "to": 5e-6},
            "young_pa": {"deviation": 5e9},
        },
        "specification": {"mean_lost_motion_arcmin": {"most": 0.9}},
        "engines": ["statics"],
    }
    there = pinwheel.sweep("steel", client=cluster, out=tmp_path / "there", **ask)
    here = pinwheel.sweep("steel", out=tmp_path / "here", **ask)
    assert results(there.out) == results(here.out) and not here.unfinished
    (statistics,) = here.tolerances
    kept = (here["mean_lost_motion_arcmin"] <= 0.9).sum()
    assert 0 < kept < 48 and statistics["yield"]["kept"] == kept == here["within_specification"].sum()
    lost = next(figure for figure in statistics["figures"] if figure["key"] == "mean_lost_motion_arcmin")
    assert lost["quantiles"][2]["value"] == pytest.approx(np.median(here["mean_lost_motion_arcmin"]), rel=1e-12)
    # Standardised coefficients by numpy.
    inputs = np.stack([here["gear.backlash_m"], here["contact.young_pa"]])
    standard = [(x - x.mean()) / x.std() for x in (*inputs, here["mean_lost_motion_arcmin"])]
    slopes = np.linalg.lstsq(np.stack(standard[:2], axis=1), standard[2], rcond=None)[0]
    ours = {of["key"]: of["coefficient"] for of in lost["sensitivities"]}
    assert [ours["gear.backlash_m"], ours["contact.young_pa"]] == pytest.approx(slopes, rel=1e-9)
    with pytest.raises(pinwheel.InputError, match="no distribution"):
        pinwheel.sweep("steel", sample={"points": 4, "backlash_m": 1e-6}, engines=["statics"])


def test_bad_input(program, sweep_file, tmp_path):
    program("sweep", sweep_file.name, "--out", "done", cwd=tmp_path)
    unfinished(tmp_path / "done/runs", tmp_path / "a")
    with pytest.raises(pinwheel.InputError, match="resume=True"):
        pinwheel.sweep(sweep_file, out=tmp_path / "a")
    with pytest.raises(pinwheel.InputError, match="give a sweep file"):
        pinwheel.sweep(tmp_path / "none.toml")
    with pytest.raises(pinwheel.SceneError, match="run 2") as caught:
        pinwheel.sweep("paper", vary={"wheels": [1, 0]}, out=tmp_path / "b")
    assert caught.value.key == "gear.wheels" and "--" not in str(caught.value)
    with pytest.raises(pinwheel.InputError, match="varies over one value"):
        pinwheel.sweep("paper", vary={"wheels": 1})
    with pytest.raises(pinwheel.InputError, match="give vary="):
        pinwheel.sweep("paper", backlash_m=[0, 1e-5])
    (tmp_path / "c").mkdir()
    (tmp_path / "c/notes.txt").write_text("precious")
    with pytest.raises(OSError, match="another `out`"):
        pinwheel.sweep(sweep_file, out=tmp_path / "c")


def test_a_worker_killed_in_the_middle(cluster, expected, sweep_file, tmp_path):
    victims = []

    def kill(done, total, *_):
        if not victims and 0 < done < total:
            victims.append(next(iter(cluster.run(os.getpid).values())))
            os.kill(victims[0], signal.SIGKILL)

    pinwheel.sweep(sweep_file, client=cluster, batch=2, out=tmp_path / "ours", progress=kill)
    assert victims and results(tmp_path / "ours") == expected


def test_courses_and_divergence_on_a_cluster(cluster, program, tmp_path):
    file = tmp_path / "wild.toml"
    head = 'scene = "paper"\ncourses = "csv"\n'
    file.write_text(f"{head}[set]\nsolver.duration_s = 0.01\n[vary]\nsolver.step_s = [1e-5, 1e-4]\n")
    program("sweep", "wild.toml", "--out", "program", cwd=tmp_path, status=3)
    sweep = pinwheel.sweep(file, client=cluster, out=tmp_path / "ours")
    assert list(sweep["status"]) == ["finished", "diverged"] and sweep.unfinished == 1
    for name in ("results.csv", "runs/run-0001.csv"):
        assert (tmp_path / "ours" / name).read_bytes() == (tmp_path / "program" / name).read_bytes()


def test_own_solvers_travel(cluster, tmp_path):
    @pinwheel.engine(order=1)
    def euler(job):
        """Semi-implicit Euler."""
        angles, rates = job.angles, job.rates
        job.sample(angles, rates)
        for steps in job.intervals():
            for t, h in steps:
                job.at(t, h)
                accelerations = job.torques(t, angles, rates) / job.moments
                accelerations[job.INPUT] = 0.0
                rates = rates + h * accelerations
                angles = angles + h * rates
            job.sample(angles, rates)

    scene = Scene("paper", duration_s=5e-4)
    vary = {"backlash_m": [0.0, 1e-4, 2e-4]}
    there = pinwheel.sweep(scene, vary=vary, engines=[euler], client=cluster, out=tmp_path / "there")
    here = pinwheel.sweep(scene, vary=vary, engines=[euler], out=tmp_path / "here")
    assert not here.unfinished and results(there.out) == results(here.out)


def test_a_scheduler_that_goes_away(expected, sweep_file, tmp_path):
    scheduler = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard",
         "--scheduler-file", str(tmp_path / "scheduler.json")],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    worker = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(tmp_path / "scheduler.json"),
         "--nthreads", "1", "--no-dashboard", "--no-nanny", "--local-directory", str(tmp_path)],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        client = distributed.Client(scheduler_file=str(tmp_path / "scheduler.json"), timeout=30)

        def stop(done, total, *_):
            if 0 < done < total:
                scheduler.kill()

        with pytest.raises(ClusterError, match="resume=True"):
            pinwheel.sweep(sweep_file, client=client, batch=2, out=tmp_path / "ours", progress=stop)
        client.close(timeout=2)
    finally:
        for process in (worker, scheduler):
            process.kill()
            process.wait()
    kept = len(list((tmp_path / "ours.unfinished").glob("run-*.json")))
    assert 0 < kept < 40
    pinwheel.sweep(sweep_file, out=tmp_path / "ours", resume=True)
    assert results(tmp_path / "ours") == expected


def test_command_line(expected, sweep_file, tmp_path):
    def run(*arguments):
        return subprocess.run(
            [sys.executable, "-m", "pinwheel.cluster", *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
        )

    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        done = run("small.toml", "--scheduler", cluster.scheduler_address, "--out", "ours")
    assert (done.returncode, "40 finished" in done.stdout) == (0, True), done
    assert results(tmp_path / "ours") == expected
    gone = run("small.toml", "--scheduler", "tcp://127.0.0.1:1", "--out", "b")
    assert gone.returncode == 3 and gone.stderr.startswith("error: --scheduler") and gone.stderr.count("\n") == 1, gone
    wrong = run("small.toml", "--set", "solver.duratin_s=1")
    assert wrong.returncode == 2 and "did you mean" in wrong.stderr, wrong


def test_ctrl_c_keeps_finished_runs(sweep_file, expected, tmp_path):
    def stop(done, total, *_):
        if 0 < done < total:
            os.kill(os.getpid(), signal.SIGINT)

    long = tmp_path / "long.toml"
    long.write_text(sweep_file.read_text().replace("0.004", "0.05"))
    with pytest.raises(KeyboardInterrupt):
        pinwheel.sweep(long, jobs=1, out=tmp_path / "long", progress=stop)
    assert list((tmp_path / "long.unfinished").glob("run-*.json"))
    assert not pinwheel.sweep(long, out=tmp_path / "long", resume=True).unfinished
