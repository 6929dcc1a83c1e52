"""Live page over the kernel's messages, and pages in cells, for a hub's browser, which cannot reach this machine."""

import json
import os
import shutil
import subprocess
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

import pinwheel

CHROMIUM = os.environ.get("PINWHEEL_CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
# A cell's host: the widget's script, whose messages go to `Explorer.answer` here.
HOST = """<!doctype html><body><script type="module">
import widget from './widget.js';
const hears = new Set();
const model = {
  get: () => 500,
  on: (_, hear) => hears.add(hear),
  off: (_, hear) => hears.delete(hear),
  send: async ({ id, view, ...asked }) => {
    const answer = await (await fetch('answer', { method: 'POST', body: JSON.stringify(asked) })).json();
    for (const hear of hears) hear({ id, view, ...answer });
  },
};
widget.render({ model, el: document.body });
</script>"""


@pytest.mark.skipif(not CHROMIUM, reason="no Chromium is here")
def test_a_page_in_a_cell_gets_its_answers_by_messages(tmp_path):
    asked = []
    done = threading.Event()
    script = Path(pinwheel.__file__).with_name("_explore.js").read_text()

    class Host(BaseHTTPRequestHandler):
        def do_GET(self):
            kind, text = ("text/javascript", script) if self.path == "/widget.js" else ("text/html", HOST)
            self.answer(kind, text)

        def do_POST(self):
            message = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            answer = page.answer(message)
            asked.append((message["path"].split("?")[0], answer["status"]))
            if {"", "balances", "bands", "status"} <= {path for path, _ in asked}:
                done.set()
            self.answer("application/json", json.dumps(answer))

        def answer(self, kind, text):
            body = text.encode()
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *args):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Host)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", f"--user-data-dir={tmp_path}"]
    with pinwheel.explore("steel") as page:
        at = f"http://127.0.0.1:{server.server_port}/"
        browser = subprocess.Popen([CHROMIUM, *flags, at], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        try:
            # The page requests bands after it has read its balances.
            assert done.wait(60.0), asked
        finally:
            browser.terminate()
            browser.wait(20.0)
            server.shutdown()
    assert {status for _, status in asked} == {200}, asked


def test_a_kernel_answers_the_widgets_messages():
    pytest.importorskip("anywidget")
    from jupyter_client.manager import start_new_kernel

    manager, client = start_new_kernel()
    try:
        client.execute_interactive("import pinwheel; page = pinwheel.explore('paper')", timeout=60)
        shown = []
        client.execute_interactive("page", timeout=60, output_hook=shown.append)
        opened = [one["content"] for one in shown if one["msg_type"] == "comm_open"]
        cell = next(one for one in opened if "_esm" in one["data"]["state"])
        views = [one["content"]["data"] for one in shown if one["msg_type"] == "execute_result"]
        assert "application/vnd.jupyter.widget-view+json" in views[0] and "127.0.0.1" not in cell["data"]["state"]["_esm"]
        custom = {
            "method": "custom",
            "content": {"id": 7, "view": 0.5, "path": "run", "body": '[["gear.backlash_m", "1e-4"]]'},
        }
        client.shell_channel.send(client.session.msg("comm_msg", {"comm_id": cell["comm_id"], "data": custom}))
        begun = time.monotonic()
        while time.monotonic() - begun < 60.0:
            message = client.get_iopub_msg(timeout=60)
            if message["msg_type"] == "comm_msg":
                break
        answer = message["content"]["data"]["content"]
        assert (answer["id"], answer["view"], answer["status"]) == (7, 0.5, 200) and "torque" in answer["text"]
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def test_questions_that_have_no_answer():
    page = pinwheel.explore("paper")
    assert page.answer({"path": "nowhere"})["status"] == 404
    assert "not a list" in page.answer({"path": "run", "body": "{"})["text"]
    page.close()
    assert page.answer({"path": "status"})["status"] == 503


def test_a_cell_holds_all_of_a_page():
    comparison = pinwheel.compare(pinwheel.Scene("paper", duration_s=1e-3), ["native-reduced", "native-lagrange"])
    cell = comparison.frame(height=300)._repr_html_()
    assert cell.startswith('<iframe srcdoc="&lt;!doctype html') and 'src="' not in cell and "300px" in cell
