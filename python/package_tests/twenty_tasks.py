"""Twenty tasks of a user's, each in a few lines; at mypy strict (test_tasks.py runs and checks them)."""

import pickle
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np

import pinwheel


@pinwheel.engine(track="shared-law", order=1)
def my_euler(job: pinwheel.Job) -> None:
    """Euler's method."""
    angles, rates = job.angles, job.rates
    job.sample(angles, rates)
    for steps in job.intervals():
        for start, length in steps:
            job.at(start, length)
            accelerations = job.torques(start, angles, rates) / job.moments
            accelerations[job.INPUT] = 0.0
            rates = rates + length * accelerations
            angles = angles + length * rates
        job.sample(angles, rates)


def main(place: Path) -> None:
    # 1 A gear of a catalogue's data
    gear = pinwheel.gear(ratio=11, pin_circle_diameter_mm=104, torque_n_m=200, speed_rpm=1500, ideal=True)
    assert gear["external_sleeves"] == 12
    # 2 Its figures, each with its uncertainty
    figures = pinwheel.statics(gear)
    lost = figures["lost_motion_arcmin"]
    assert lost.value is not None and lost.uncertainty is not None and 0.0 < lost.uncertainty < lost.value
    # 3 All of them as a table
    assert list(figures.to_pandas().index) == list(figures)
    # 4 The discs as drawings
    assert figures.limits and "margin" in figures.bears_its_load
    assert "POLYLINE" in figures.save_dxf(place / "dxf")[0].read_text()
    # 5 A modified profile, and what it changes
    looser = pinwheel.statics(gear.with_(backlash_m=5e-6))
    assert float(looser["lost_motion_arcmin"]) > float(lost)
    # 6 A scene as a file
    gear.save(place / "gear.toml")
    assert pinwheel.Scene(place / "gear.toml").to_dict() == gear.to_dict()
    # 7 A preset with keys set, in short and in full
    scene = pinwheel.Scene("paper", {"mass.wheel.mass_kg": 0.6}, backlash_m=1e-4, duration_s=0.004, wheels=2)
    # 8 A run, and one of its courses
    run = scene.run("native")
    assert run["external_sleeve_force_n"].shape == (41, 16) and dict(run).keys() == set(run)
    # 9 The pin with the largest force, by its angle, in xarray
    forces = run.to_xarray()["external_sleeve_force_n"]
    assert float(forces.max("time_s").idxmax("external_sleeve")) in range(16) and forces.attrs["units"] == "N"
    # 10 Spectra by way of pandas
    assert np.fft.rfft(run.to_pandas()["input_torque_n_m"]).size == 21
    # 11 Plots: of the run into axes of mine, and of the gear
    axes = run.plot("input_torque_n_m")
    assert scene.plot().get_xlabel() == "x, mm" and axes.get_ylabel() == "driver torque, N m"
    # 12 Runs kept and read again, here and in another process
    run.save(place / "run")
    for again in (pinwheel.Run.load(place / "run"), pickle.loads(pickle.dumps(run))):
        assert (
            np.array_equal(again["input_torque_n_m"], run["input_torque_n_m"]) and again.scene.to_dict() == scene.to_dict()
        )
    # 13 A solver of mine against the others
    comparison = pinwheel.compare(scene.with_(duration_s=4e-4), ["native", my_euler])
    assert comparison[my_euler].time_s.size == comparison["native"].time_s.size
    # 14 What is not confirmed, and why; the comparison travels
    assert all(verdict.reason for verdict in comparison.verdicts if verdict.verdict == "inconclusive")
    assert pickle.loads(pickle.dumps(comparison)).page().startswith("<!")
    # 15 A map over two keys
    grid = pinwheel.sweep(
        scene, vary={"backlash_m": [0.0, 1e-4], "contact.damping_n_s_m": np.array([8.0, 16.0])}, out=place / "grid"
    )
    assert grid.to_xarray()["peak_external_sleeve_force_n"].sizes == {
        "engine": 1, "gear.backlash_m": 2, "contact.damping_n_s_m": 2,
    }  # fmt: skip
    assert grid.plot("peak_external_sleeve_force_n").get_xlabel() == "contact.damping_n_s_m [N s/m]"
    # 16 An earlier sweep read again
    assert pinwheel.Sweep.load(place / "grid").to_pandas().equals(grid.to_pandas())
    # 17 Tolerances: quantiles of lost motion, and the yield
    drawn = pinwheel.sweep(
        "steel",
        sample={"points": 16, "backlash_m": {"from": 2e-6, "to": 8e-6}},
        specification={"mean_lost_motion_arcmin": {"most": 1.4}},
        engines="statics",
        out=place / "drawn",
    )
    quantiles = drawn.tolerances_to_pandas().set_index("figure")
    assert quantiles.loc["mean_lost_motion_arcmin", "quantile_50_percent"] > 0.0
    assert 0.0 < drawn.tolerances[0]["yield"]["share"] <= 1.0
    # 18 A contact law on arrays
    assert pinwheel.Law("paper", damping_n_s_m=0.0)(9e7, np.linspace(0.0, 1e-5, 5)).shape == (5,)
    # 19 A co-simulation unit
    with zipfile.ZipFile(pinwheel.fmu(scene, place / "unit.fmu")) as unit:
        assert "modelDescription.xml" in unit.namelist()
    # 20 The program
    shown = subprocess.run([sys.executable, "-m", "pinwheel", "--version"], capture_output=True, text=True, check=True)
    assert pinwheel.__version__ in shown.stdout


if __name__ == "__main__":
    main(Path(sys.argv[1]))
