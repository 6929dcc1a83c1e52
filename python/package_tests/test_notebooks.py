"""Every notebook runs from its first cell to its last, and is kept without outputs."""

from pathlib import Path

import nbformat
import pytest
from conftest import ROOT
from nbclient import NotebookClient

NOTEBOOKS = sorted((ROOT / "python/notebooks").glob("*.ipynb"))
# Statements of a notebook's text about its outputs.
SAYS = {
    "3-own-solver": ["'differ'"],
    "4-sweep-on-a-cluster": ["True", "% from the peaks"],
    "5-measurement-to-statement": ["steady input_torque_n_m mean agree", "transient input_torque_n_m rms differ"],
}


def test_there_are_seven():
    assert len(NOTEBOOKS) == 7


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook(path: Path, tmp_path, monkeypatch):
    # Fewer than a reader has: the package is tested unoptimised.
    monkeypatch.setenv("TRIALS", "3")
    monkeypatch.setenv("POINTS", "2")
    notebook = nbformat.read(path, as_version=4)
    for cell in notebook.cells:
        assert not cell.get("outputs") and cell.get("execution_count") is None, "clear the outputs before a commit"
    client = NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}})
    client.execute()
    shown = ""
    for cell in notebook.cells:
        outputs = cell.get("outputs", [])
        assert outputs or "print(" not in cell.source, f"nothing is printed by\n{cell.source}"
        shown += "".join(out.get("text", "") + out.get("data", {}).get("text/plain", "") for out in outputs)
    for words in SAYS.get(path.stem, []):
        assert words in " ".join(shown.split())
