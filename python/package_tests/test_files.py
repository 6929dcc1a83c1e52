"""Files that users name: nothing of theirs is lost."""

import os
from pathlib import Path

import pytest

import pinwheel

SHORT = pinwheel.Scene("paper", duration_s=1e-3)


def test_only_files_of_their_kind_are_replaced(tmp_path: Path) -> None:
    run = SHORT.run("native-reduced")
    comparison = pinwheel.compare(SHORT, ["native-reduced"], progress=False)
    writers = {"f.toml": SHORT.save, "f.csv": run.to_csv, "f": run.save, "f.html": comparison.show}
    for name, write in writers.items():
        file = tmp_path / name
        write(file)
        write(file)
        inner = file / "run.json" if file.is_dir() else file
        inner.write_text("thesis")
        with pytest.raises(OSError, match="name another file"):
            write(file)
        assert inner.read_text() == "thesis"
    link, mine = tmp_path / "link.toml", tmp_path / "mine.toml"
    SHORT.save(mine)
    mine.chmod(0o600)
    SHORT.save(mine)
    assert mine.stat().st_mode & 0o777 == 0o600
    link.symlink_to(mine)
    for refused in (link, tmp_path):
        with pytest.raises(OSError, match="name another file"):
            SHORT.save(refused)
    mine.chmod(0o400)
    with pytest.raises(OSError, match="only be read"):
        SHORT.save(mine)


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", "null", '{"scene": 1}', "[" * 100_000])
def test_what_is_no_run_is_bad_input(tmp_path: Path, text: str) -> None:
    (tmp_path / "run.json").write_text(text)
    (tmp_path / "courses.csv").write_text("time_s,a\n0,1\n")
    with pytest.raises(pinwheel.InputError, match="holds no run"):
        pinwheel.Run.load(tmp_path)


def test_a_scene_is_no_way_out_of_the_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    sweep = pinwheel.sweep(SHORT.with_(name="../../evil"), vary={"backlash_m": [0.0, 1e-5]})
    assert os.path.commonpath([sweep.out.resolve(), tmp_path]) == str(tmp_path)
