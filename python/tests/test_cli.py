"""The command lines: what they write, and their exit status."""

import json

import pytest

from pinwheel_engines import cli
from tests import scenes


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(scenes.paper_text())
    return path


@pytest.mark.parametrize(
    ("family", "more"),
    [
        ("mujoco", []),
        ("mujoco", ["--track", "own-contact"]),
        ("exudyn", []),
        ("exudyn", ["--form", "constrained"]),
        ("exudyn", ["--track", "own-contact"]),
    ],
)
def test_writes_courses(family, more, scene_file, tmp_path, capsys):
    out = tmp_path / "courses.csv"
    status = cli.main(family, [str(scene_file), "--duration", "2e-4", "--out", str(out), "--stats", *more])
    assert status == 0
    lines = out.read_text().splitlines()
    assert len(lines) == 4
    assert lines[0].startswith("time_s,input_torque_n_m,output_torque_n_m,output_angle_rad,external_sleeve_force_n_0")
    assert [float(line.split(",")[0]) for line in lines[1:]] == [0.0, 1e-4, 2e-4]
    stats = json.loads(capsys.readouterr().err)
    assert stats["steps"] > 0
    assert stats["versions"][family]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["courses.csv", "scene.toml"]


def test_standard_output(scene_file, capsys):
    assert cli.main("mujoco", [str(scene_file), "--duration", "1e-4", "--sample", "5e-5"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 4


def test_bad_input_is_2(tmp_path, capsys):
    assert cli.main("mujoco", [str(tmp_path / "nowhere.toml")]) == 2
    bad = tmp_path / "bad.toml"
    bad.write_text(scenes.paper_text().replace("wheels = 2", ""))
    assert cli.main("exudyn", [str(bad)]) == 2
    assert "`gear.wheels`" in capsys.readouterr().err
    with pytest.raises(SystemExit) as caught:
        cli.main("mujoco", ["--track", "both", "x"])
    assert caught.value.code == 2


@pytest.mark.parametrize("time", ["-1", "0", "nan", "inf", "soon"])
def test_bad_times_are_2(time, scene_file):
    with pytest.raises(SystemExit) as caught:
        cli.main("mujoco", [str(scene_file), f"--duration={time}"])
    assert caught.value.code == 2


def test_divergence_is_3_and_keeps_the_courses(tmp_path, capsys):
    out = tmp_path / "courses.csv"
    steel = tmp_path / "steel.toml"
    steel.write_text(scenes.paper_text(stiffness_multiplier=1.0, sample_s=1e-3, duration_s=0.05))
    assert cli.main("mujoco", [str(steel), "--step", "1e-3", "--out", str(out)]) == 3
    assert "diverged" in capsys.readouterr().err
    assert len(out.read_text().splitlines()) >= 2


def test_unsupported_is_3(tmp_path):
    path = tmp_path / "friction.toml"
    path.write_text(scenes.paper_text(friction_coefficient=0.1))
    assert cli.main("exudyn", [str(path), "--track", "own-contact"]) == 3


def test_unwritable_output_is_2(scene_file, tmp_path):
    assert cli.main("mujoco", [str(scene_file), "--duration", "1e-4", "--out", str(tmp_path / "no" / "x.csv")]) == 2


def test_help_names_the_engines(capsys):
    with pytest.raises(SystemExit) as caught:
        cli.main("exudyn", ["--help"])
    assert caught.value.code == 0
    text = capsys.readouterr().out
    for word in ("own-contact", "constrained", "--duration", "numpy"):
        assert word in text
