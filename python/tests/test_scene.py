"""The scene file: keys as attributes, values computed from them, and the error for a missing key."""

import copy
import dataclasses

import pytest

from pinwheel_engines import Scene, SceneError, run
from tests import scenes


def test_keys_are_attributes_under_the_files_names():
    scene = scenes.PAPER
    assert scene.name == "paper"
    assert scene.gear.lobes == 15
    assert scene.gear.pitch_radius_m == pytest.approx(0.064, rel=1e-15)
    assert scene.mass.wheel.moment_kg_m2 == 1.57538e-4
    assert len(scene.mass.of_bodies(scene.gear)) == 28
    assert scene.solver.sample_times_s().size == 6001
    assert copy.deepcopy(scene) == scene == Scene.from_toml(scenes.paper_text())


def test_a_scene_stays_as_it_is():
    scene = scenes.PAPER
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(scene.gear, "wheels", 3)  # noqa: B010
    other = scene.with_keys("gear", wheels=3)
    assert (scene.gear.wheels, other.gear.wheels) == (2, 3)
    assert other.gear.lobes == 15


def test_keys_of_others_are_left_alone():
    text = scenes.paper_text(duration_s=1e-4) + "some_new_key = 1\n[some_new_table]\nkey = 2\n"
    assert run(text, "mujoco-shared-law").stats.steps == 10


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (scenes.paper_text().replace("hole_radius_m =", "other_radius_m ="), "`gear.hole_radius_m` is missing"),
        (scenes.paper_text().replace("wheel = { mass_kg = 0.5998,", "wheel = {"), "`mass.wheel.mass_kg` is missing"),
        ('name = "mine"\nbase = "paper"\n', "is missing; these engines take complete scenes"),
        ("gear = 3", "`gear` must be a table"),
        ("gear = [", "not valid TOML"),
    ],
)
def test_faults_name_the_key(text, words):
    with pytest.raises(SceneError, match=words) as caught:
        run(text, "exudyn-shared-law-explicit")
    assert "\n" not in str(caught.value)


def test_missing_file_is_a_scene_error(tmp_path):
    with pytest.raises(SceneError, match=r"nowhere\.toml"):
        Scene.load(tmp_path / "nowhere.toml")


def test_samples_end_at_the_end():
    times = scenes.scene(duration_s=2.5e-4).solver.sample_times_s()
    assert times.tolist() == [0.0, 1e-4, 2e-4, 2.5e-4]
    assert scenes.scene(duration_s=3e-4).solver.sample_times_s().tolist() == [0.0, 1e-4, 2e-4, 3e-4]


def test_load_ramps_up():
    drive = scenes.scene("[drive]\nload_ramp_s = 0.02").drive
    assert [drive.load_n_m(t) for t in (-1.0, 0.0, 0.01, 0.02, 1.0)] == [0.0, 0.0, 11.0, 22.0, 22.0]
    assert drive.load_breaks_s == []


def test_load_changes():
    drive = scenes.scene("""[drive]
load_changes = [
  { time_s = 0.1, output_torque_n_m = 44.0, ramp_s = 0.0 },
  { time_s = 0.2, output_torque_n_m = -22, ramp_s = 0.1 },
  { time_s = 0.3, output_torque_n_m = 0.0, ramp_s = 0.0 },
]
""").drive
    # At a jump the load is what it jumps to; the piece that ends keeps its own.
    assert [drive.load_n_m(t) for t in (0.0, 0.1, 0.2, 0.25, 0.3, 9.0)] == pytest.approx([22.0, 44.0, 44.0, 11.0, 0.0, 0.0])
    assert drive.load_piece(0.05).load_n_m(0.1) == 22.0
    # 0.2 + 0.1 is more than 0.3 by a rounding: one break.
    assert drive.load_breaks_s == [0.1, 0.2, 0.3]
    assert drive.largest_load_n_m == 44.0
