"""Figures have one name and one unit; a wrong name gives a suggestion."""

import numpy as np
import pytest

import pinwheel
from pinwheel import Missing, Scene, _core

SHORT = Scene("paper", duration_s=0.004)
UNITS = {key: unit or "1" for key, _, unit, _ in _core.figures()}
STATISTICS = ("mean", "least", "min", "max", "rms", "peak")
# Columns of a sweep only, which describe the window and the balance of a run's figures.
OWN = {"diverged_at_s", "window_from_s", "window_to_s", "efficiency_accounted", "energy_remainder_share"}


def is_known(key, columns):
    statistic, _, of = key.partition("_")
    return key in UNITS or (statistic in STATISTICS and (of in UNITS or of in columns))


def test_every_study_has_the_figures_of_the_list(tmp_path):
    run = SHORT.run("native")
    keys = {*pinwheel.statics("steel"), *pinwheel.design(SHORT), *(figure["key"] for figure in run.results["figures"])}
    assert {"lost_motion_arcmin", "efficiency_rated_percent", "mean_input_torque_n_m"} <= keys
    vary = {"backlash_m": [2e-6, 4e-6]}
    for engine in ("statics", "native"):
        sweep = pinwheel.sweep(
            Scene("steel", duration_s=0.004), vary=vary, engines=engine, out=tmp_path / engine, progress=False
        )
        names = list(sweep)
        figures = names[names.index("status") + 1 : names.index("reason")]
        keys |= {*figures} - OWN - {"steps", "rhs_calls"}
        data = sweep.to_xarray()
        for name, units in ((name, one.attrs.get("units")) for name, one in data.data_vars.items()):
            assert units == UNITS.get(name, units), name
        assert data["gear.backlash_m"].attrs == {"units": "m"}
    assert not [key for key in keys if not is_known(key, set(run.columns))]
    for figure in run.results["figures"]:
        assert UNITS.get(figure["key"], figure["unit"]) == figure["unit"] or not figure["unit"]
    for figure in pinwheel.design(SHORT).values():
        assert (figure.unit or "1") == UNITS[figure.key] and pinwheel.figures()[figure.key].startswith(figure.what)


def test_a_wrong_name_is_an_error_of_ours(tmp_path):
    swept = pinwheel.sweep(SHORT, vary={"backlash_m": [0.0, 1e-5]}, engines="native", out=tmp_path / "out", progress=False)
    run, design = SHORT.run("native", check=False), pinwheel.statics("steel")
    for ask in (
        lambda: run["input_torqe_n_m"],
        lambda: run.plot("input_torqe_n_m"),
        lambda: run.columns["input_torqe_n_m"],
        lambda: swept["mean_input_torqe_n_m"],
        lambda: swept.plot("mean_input_torqe_n_m"),
        lambda: design["lost_moton_arcmin"],
        lambda: pinwheel.design(SHORT)["eficiency_rated_percent"],
    ):
        with pytest.raises(Missing, match="did you mean `"):
            ask()
    with pytest.raises(Missing, match=r"`efficiency_rated_percent` is not among.*`pinwheel\.design`"):
        design["efficiency_rated_percent"]
    for wrong in ({"measure": ["input_torqe_n_m"]}, {"specification": {"peak_input_torqe_n_m": {"most": 1.0}}}):
        with pytest.raises(pinwheel.InputError, match=r"did you mean|there are"):
            pinwheel.sweep(SHORT, vary={"backlash_m": [0.0]}, out=tmp_path / "wrong", progress=False, **wrong)


def test_tables_are_of_the_library_that_was_asked_for(tmp_path):
    import pandas as pd
    import polars as pl
    import xarray as xr

    run = SHORT.run("native", check=False)
    swept = pinwheel.sweep(SHORT, vary={"backlash_m": [0.0, 1e-5]}, engines="native", out=tmp_path / "out", progress=False)
    compared = pinwheel.compare(Scene("paper", duration_s=1e-3), ["native-reduced", "native-lagrange"])
    benched = pinwheel.bench(Scene("paper", duration_s=1e-3), ["native"], repeats=1, methods=["rk2"])
    tables = [
        *((made, "to_pandas", "pandas.DataFrame", pd.DataFrame) for made in (run, run.columns, swept, compared, benched)),
        (pinwheel.statics("steel"), "to_pandas", "pandas.DataFrame", pd.DataFrame),
        *((made, "to_polars", "polars.DataFrame", pl.DataFrame) for made in (run, run.columns, swept)),
        *((made, "to_xarray", "xarray.Dataset", xr.Dataset) for made in (run, run.columns, swept)),
    ]
    for made, method, annotation, kind in tables:
        table = getattr(made, method)
        assert table.__annotations__["return"] == annotation and isinstance(table(), kind), (type(made), method)
    # Tidy: a row an observation, a column a variable.
    assert {"a", "b", "window", "quantity", "verdict", "distance", "uncertainty"} <= {*compared.to_pandas()}
    assert {"engine", "method", "cpu_median_s"} <= {*benched.to_pandas()}


def test_a_dataset_is_one_line_from_a_file(tmp_path):
    xr, _ = pytest.importorskip("xarray"), pytest.importorskip("netCDF4")
    run = SHORT.run("native", check=False)
    run.to_xarray().to_netcdf(tmp_path / "r.nc")
    with xr.open_dataset(tmp_path / "r.nc") as again:
        force = again["external_sleeve_force_n"]
        assert np.array_equal(force, run["external_sleeve_force_n"])
        assert force.attrs == {"units": "N", "long_name": "ring pin force"} and "paper" in again.attrs["scene_toml"]
    stiffness = Scene("paper", duration_s=1e-3, channels=["wheel_0_external_stiffness_n_m15_*"]).run(check=False).to_xarray()
    assert {one.attrs["units"] for name, one in stiffness.data_vars.items() if "stiffness" in name} == {"N/m^1.5"}


def test_a_comparison_keeps_runs_of_others_and_runs_side_by_side(tmp_path, monkeypatch):
    monkeypatch.setenv("PINWHEEL_RUNS", str(tmp_path / "runs"))
    scene, engines = Scene("paper", duration_s=2e-3), ["native-reduced", "rapier-shared-law"]
    first, again = (pinwheel.compare(scene, engines, jobs=jobs) for jobs in (1, 2))
    assert list((tmp_path / "runs").glob("rapier-shared-law-*.run"))
    anew = pinwheel.compare(scene, engines, fresh=True)
    kept = [[bool(engine["cost"].get("kept")) for engine in one.data["engines"]] for one in (first, again, anew)]
    assert kept == [[False, False], [False, True], [False, False]]
    assert first.verdicts == again.verdicts == anew.verdicts
    with pytest.raises(pinwheel.InputError, match="jobs = 0"):
        pinwheel.compare(scene, engines, jobs=0)
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("PINWHEEL_RUNS", str(tmp_path / "file"))
    with pytest.warns(UserWarning, match="not kept"):
        pinwheel.compare(scene, engines)
