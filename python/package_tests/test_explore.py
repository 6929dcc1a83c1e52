"""Live page from Python."""

import os
import subprocess
import sys
import time
import urllib.request
from pathlib import Path
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit

import pytest

import pinwheel


def fetched(url, **headers):
    with urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=20) as answer:
        return answer.read().decode()


def test_a_notebook_shows_it_until_it_is_closed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = pinwheel.explore(pinwheel.Scene("paper", backlash_m=2e-4), height=500)
    assert f'src="{page.url}"' in page._repr_html_() and "500px" in page._repr_html_()
    assert "<title>" in fetched(page.url)
    # Requests of the page itself: a run of a moved slider, and the scene as a file in the working folder.
    at = urlsplit(page.url)
    own = {"Origin": f"{at.scheme}://{at.netloc}", "Content-Type": "application/json"}

    def post(what):
        asked = urllib.request.Request(page.url + what, b'[["gear.backlash_m", "1e-4"]]', own)
        return urllib.request.urlopen(asked, timeout=20).read().decode()

    assert "torque" in post("run")
    post("save")
    assert pinwheel.Scene("paper-explored.toml")["backlash_m"] == 1e-4
    for wrong in (f"{at.scheme}://{at.netloc}/", page.url[:-2] + "/"):
        with pytest.raises(HTTPError, match="403"):
            fetched(wrong)
    scene = Path(page._folder.name)
    page.close()
    page.close()
    assert page.closed and not scene.exists() and "closed" in page._repr_html_()
    with pytest.raises(URLError):
        fetched(page.url)


@pytest.mark.parametrize("end", ["exit", "kill"])
def test_it_ends_with_python(end):
    code = "import pinwheel, sys; print(pinwheel.explore('paper').url, flush=True); sys.stdin.read()"
    python = subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    url = python.stdout.readline().strip()
    assert "<title>" in fetched(url)
    python.stdin.close() if end == "exit" else python.kill()
    python.wait(20.0)
    for _ in range(100):
        try:
            fetched(url)
        except URLError:
            return
        time.sleep(0.1)
    pytest.fail("still served")


@pytest.mark.skipif(os.name == "nt", reason="groups of processes are Unix's")
def test_a_cell_that_is_interrupted_leaves_it():
    # Jupyter interrupts the kernel's complete process group.
    code = """
import os, signal, time, urllib.request
import pinwheel
page = pinwheel.explore("paper")
try:
    os.killpg(0, signal.SIGINT)
    time.sleep(20.0)
except KeyboardInterrupt:
    time.sleep(1.0)
print(urllib.request.urlopen(page.url).status)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, start_new_session=True, timeout=60)
    assert done.stdout.strip() == "200", done.stderr


def test_why_there_is_none():
    with pytest.raises(pinwheel.InputError, match="papr"):
        pinwheel.explore("papr")
