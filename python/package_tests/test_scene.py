"""Scenes: how they are made, changed, compared, sent, and refused."""

import pickle

import numpy as np
import pytest
from conftest import ROOT

import pinwheel
from pinwheel import Scene, SceneError

MINE = {
    "gear": {
        "eccentricity_m": 0.00075,
        "external_sleeves": 40,
        "pin_circle_radius_m": 0.052,
        "external_sleeve_radius_m": 0.002,
        "internal_sleeves": 10,
        "internal_sleeve_radius_m": 0.004,
        "internal_circle_radius_m": 0.032,
        "wheels": 2,
    },
    "drive": {"input_speed_rad_s": 100.0, "output_torque_n_m": 200.0},
}


def test_ways_to_one_scene():
    by_key = Scene("paper", backlash_m=6e-4)
    assert by_key == Scene("paper", **{"gear.backlash_m": np.float64(6e-4)})
    assert by_key == Scene("paper", gear={"backlash_m": 6e-4})
    assert by_key == Scene("paper").with_(backlash_m=6e-4)
    assert by_key == Scene(ROOT / "reference/scenes/paper.toml", backlash_m=6e-4)
    assert by_key == Scene.from_toml(by_key.to_toml())
    assert by_key == Scene(base="paper", name="paper", description=by_key["description"], backlash_m=6e-4)
    assert by_key != Scene("paper")
    assert len({by_key, Scene("paper", backlash_m=6e-4), Scene("paper")}) == 2


def test_what_is_left_out_follows_again():
    mine = Scene(MINE)
    assert mine["hole_radius_m"] == pytest.approx(0.00475)
    assert "gear.hole_radius_m" in mine.assumed
    wider = mine.with_(internal_sleeve_radius_m=0.0041)
    assert wider["hole_radius_m"] == pytest.approx(0.00485)
    assert wider["gear"]["wheels"] == 2


def test_changes_of_the_load_are_tables():
    scene = Scene("paper", load_changes=[{"time_s": 0.3, "output_torque_n_m": -22.0}])
    assert scene["drive.load_changes"][0]["output_torque_n_m"] == -22.0


def test_scenes_travel_without_their_files(tmp_path):
    base, file = tmp_path / "base.toml", tmp_path / "mine.toml"
    base.write_text(Scene("paper").to_toml())
    file.write_text('base = "base.toml"\n[gear]\nbacklash_m = 1e-4\n')
    scene = Scene(file, wheels=1)
    sent = pickle.dumps(scene)
    assert pickle.loads(sent) == scene and pickle.loads(sent).with_(wheels=2)["backlash_m"] == 1e-4
    base.unlink()
    assert pickle.loads(sent) == scene


def test_scenes_never_change():
    scene = Scene("paper")
    with pytest.raises(AttributeError, match="with_"):
        scene.name = "other"
    with pytest.raises(AttributeError, match="with_"):
        del scene._toml


def test_a_scene_is_a_mapping_of_its_keys():
    scene = Scene("paper")
    assert "backlash_m" in scene and "gear.backlash_m" in scene and "backlsh_m" not in scene and 3 not in scene
    assert list(scene) == list(scene.keys()) and dict(scene)["gear.wheels"] == 2


def test_repr_makes_it_again():
    scene = Scene("paper", backlash_m=6e-4, law="constant")
    assert repr(scene) == "Scene('paper', backlash_m=0.0006, law=\"constant\")"
    assert eval(repr(scene)) == scene
    assert "gear.backlash_m" in scene._repr_html_()


@pytest.mark.parametrize(
    ("keys", "key", "part"),
    [
        ({"backlsh_m": 0.0}, "backlsh_m", "did you mean `backlash_m`?"),
        ({"gear.backlsh_m": 0.0}, "gear.backlsh_m", "did you mean `gear.backlash_m`?"),
        ({"mass_kg": 1.0}, "mass_kg", "write one of `mass.input_shaft.mass_kg`"),
        ({"wheels": 0}, "gear.wheels", "must be"),
        ({"wheels": "two"}, "gear.wheels", "`gear.wheels`"),
        ({"step_s": float("nan")}, "solver.step_s", "`solver.step_s`"),
        ({"eccentricity_m": 0.05}, None, "`gear."),
    ],
)
def test_bad_input_names_the_key(keys, key, part):
    with pytest.raises(SceneError) as caught:
        Scene("paper", **keys)
    line = str(caught.value)
    assert part in line and "--" not in line and "\n" not in line, line
    assert key is None or caught.value.key == key
    assert isinstance(caught.value, ValueError)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.key) == (line, caught.value.key)


def test_bad_input_of_files(tmp_path):
    with pytest.raises(SceneError, match="did you mean the preset `paper`"):
        Scene("papr")
    file = tmp_path / "mine.toml"
    file.write_text('base = "paper"\n[gear]\nwheels = 0\n')
    with pytest.raises(SceneError, match=r"mine.toml, line 3: `gear.wheels`"):
        Scene(file)
    with pytest.raises(SceneError, match="gives no `gear"):
        Scene({"gear": {"wheels": 1}})
    with pytest.raises(TypeError, match="not set"):
        Scene("paper", channels={1, 2})


def test_lists():
    assert "paper" in pinwheel.presets() and "gear.backlash_m" in pinwheel.keys()
    assert "derived" in pinwheel.explain(Scene(MINE)).data
