"""The page and the video in a real browser: Debian's chromium, or none and these tests are skipped."""

from __future__ import annotations

import base64
import json
import math
import queue
import shutil
import subprocess
import threading
import urllib.parse
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import Any

import pytest

from cli.main import main

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")

Browse = Callable[[str], Any]

REPORT = """
const report = (result) => {
  new Image().src = `http://127.0.0.1:PORT/?${encodeURIComponent(JSON.stringify(result))}`;
};
const failed = (e) => report({ error: String(e.reason || e.message || e) });
addEventListener("error", failed);
addEventListener("unhandledrejection", failed);
"""


@pytest.fixture
def browse(tmp_path: Path) -> Iterator[Browse]:
    """Opens an HTML text whose scripts say report(result) once, and gives the result."""
    results: queue.Queue[Any] = queue.Queue()

    class Answer(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(204)
            self.end_headers()
            results.put(json.loads(urllib.parse.unquote(self.path.partition("?")[2])))

        def log_message(self, *_: object) -> None:
            pass

    server = HTTPServer(("127.0.0.1", 0), Answer)
    serving = threading.Thread(target=server.serve_forever, daemon=True)
    serving.start()

    def open_page(html: str) -> Any:
        page = tmp_path / "page.html"
        report = REPORT.replace("PORT", str(server.server_port))
        page.write_text(html.replace("<script", f"<script>{report}</script>\n<script", 1), encoding="utf-8")
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--autoplay-policy=no-user-gesture-required"]
        with subprocess.Popen(
            [
                str(CHROMIUM),
                *flags,
                "--remote-debugging-port=0",
                f"--user-data-dir={tmp_path / 'profile'}",
                page.as_uri(),
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        ) as browser:
            try:
                result = results.get(timeout=40)
            finally:
                browser.terminate()
        assert "error" not in result, result
        return result

    yield open_page
    server.shutdown()
    server.server_close()
    serving.join()


def page_of(scene_file: Path, script: str, *options: str) -> str:
    """The page of one second of the scene at 20 fps, with a script after its own."""
    out = scene_file.parent / "run.html"
    argv = [
        "simulate",
        str(scene_file),
        "-o",
        str(out),
        "--duration",
        "1",
        "--fps",
        "20",
        "--size",
        "640x480",
        *options,
    ]
    assert main(argv) == 0
    return out.read_text("utf-8").replace("</body>", f"<script>{script}</script></body>")


PLAY = """
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const key = (name) => document.dispatchEvent(new KeyboardEvent("keydown", { key: name, bubbles: true }));
const click = (id) => document.getElementById(id).click();
const value = (id) => document.getElementById(id).value;
const pixel = (x, y) => {
  const stage = document.getElementById("stage");
  const k = stage.width / 640;
  const { data } = stage.getContext("2d").getImageData(Math.round(x * k), Math.round(y * k), 1, 1);
  return [...data].slice(0, 3);
};
"""


def test_the_page_plays_steps_winds_and_draws(scene_file: Path, browse: Browse) -> None:
    """160 pixels a metre; the ball starts at x = 0.75 m and does 2 m/s along y = -1.5 m."""
    script = """(async () => {
      const graphs = document.querySelectorAll(".graph");
      const seen = { duration: player.recording.duration, graphs: graphs.length };
      seen.start = pixel(0.75 * 160 - 30, 1.5 * 160 + 30);
      click("play");
      await wait(300);
      seen.played = player.time;
      click("play");
      seen.paused = !player.playing;
      key("End"); seen.end = player.time;
      seen.ended = pixel(2.75 * 160 - 30, 1.5 * 160 + 30);
      seen.left = pixel(0.75 * 160 - 30, 1.5 * 160 + 30);
      key("ArrowLeft"); seen.back = player.time;
      key("ArrowRight"); seen.on = player.time;
      key("Home"); seen.home = player.time;
      key("End"); key("j"); key("j"); seen.rate = player.rate; await wait(250);
      seen.rewound = player.time; player.pause();
      player.seek(0.525); seen.between = player.recording.at(1, 0.525);
      const scrub = document.getElementById("scrub");
      scrub.value = 0.4; scrub.dispatchEvent(new Event("input"));
      seen.scrubbed = player.time;
      key("+"); seen.speed = player.speed;
      key("l"); key("v"); key("t");
      seen.switches = [player.loop, player.vectors, player.trails];
      player.seek(0.95); player.play(); await wait(200); seen.looped = player.time < 0.9; player.pause();
      report(seen);
    })();"""
    seen = browse(page_of(scene_file, PLAY + script))
    assert seen["duration"] == 1
    assert seen["graphs"] == 4
    for name in ("start", "ended"):
        r, _, b = seen[name]
        assert b > 200, name
        assert r < 80, name
    assert min(seen["left"]) > 200
    assert 0.1 < seen["played"] < 0.9
    assert seen["paused"]
    assert (seen["end"], seen["back"], seen["on"], seen["home"]) == (1, 0.95, 1, 0)
    assert seen["rate"] == -4
    assert seen["rewound"] < 0.6
    assert seen["between"][:2] == pytest.approx([0.75 + 2 * 0.525, -1.5], abs=1e-6)
    assert seen["scrubbed"] == 0.4
    assert seen["speed"] == 2
    assert seen["switches"] == [True, True, True]
    assert seen["looped"]


def test_the_page_follows_a_body(scene_file: Path, browse: Browse) -> None:
    """The ball stays in the middle, and is found there by a click; what stands still goes by."""
    script = """(async () => {
      const seen = { body: player.body, vectors: player.vectors, at: [], clicked: [] };
      const box = document.getElementById("stage").getBoundingClientRect();
      for (const time of [0, 0.5, 1]) {
        player.seek(time);
        seen.at.push(pixel(320 - 30, 240 + 30));
        seen.clicked.push(stage_.bodyAt(box.left + box.width / 2 - 9, box.top + box.height / 2));
      }
      report(seen);
    })();""".replace("stage_", "new Stage(document.getElementById('stage'), player)")
    seen = browse(page_of(scene_file, PLAY + script, "--camera", "follow:ball", "--vectors"))
    assert (seen["body"], seen["vectors"]) == (1, True)
    assert all(b > 180 and r < 100 for r, _, b in seen["at"])
    assert seen["clicked"] == [1, 1, 1]


def test_the_page_lets_one_choose_a_body_by_touch(scene_file: Path, browse: Browse) -> None:
    script = """(async () => {
      const stage = document.getElementById("stage");
      const touch = (x, y) => {
        const box = stage.getBoundingClientRect();
        const k = box.width / 640;
        const at = { clientX: box.left + x * k, clientY: box.top + y * k, pointerType: "touch" };
        stage.dispatchEvent(new PointerEvent("pointerup", { ...at, bubbles: true }));
      };
      const seen = { first: player.body };
      touch(3 * 160, 0.45 * 160); seen.box = player.body;
      touch(0.75 * 160 + 40, 1.5 * 160); seen.ball = player.body;
      touch(2 * 160, 2.75 * 160); seen.floor = player.body;
      touch(0.75 * 160 + 60, 1.5 * 160 + 60); seen.besides = player.body; seen.playing = player.playing;
      seen.momentum = player.recording.curves("momentum", 1)[0][1](3);
      report(seen);
    })();"""
    seen = browse(page_of(scene_file, PLAY + script))
    assert [seen[name] for name in ("first", "box", "ball", "floor", "besides")] == [1, 2, 1, 0, 0]
    assert seen["playing"]
    assert seen["momentum"] == pytest.approx(3.14159265 * 0.25 * 2, rel=1e-6)


def test_the_page_moves_the_ink(tmp_path: Path, browse: Browse) -> None:
    """A ball drawn on a page without gravity: its ring is at the top of the ball, wherever the ball is."""
    drawing, out = tmp_path / "ball.json", tmp_path / "run.html"
    ring = [[160 + 60 * math.cos(k / 10), 240 + 60 * math.sin(k / 10)] for k in range(63)]
    sketch = {"width": 640, "height": 480, "pixels_per_metre": 100, "strokes": [{"points": ring}]}
    drawing.write_text(json.dumps(sketch))
    argv = [
        "simulate",
        str(drawing),
        "-o",
        str(out),
        "--style",
        "ink",
        "--size",
        "640x480",
        "--duration",
        "1",
    ]
    assert main([*argv, "-q", "--gravity", "4,0"]) == 0
    script = """
      const darkest = (x) => Math.min(...[...Array(9)].map((_, k) => Math.max(...pixel(x, 176 + k))));
      const seen = { before: [darkest(160), darkest(360)] };
      player.seek(1);
      seen.after = [darkest(160), darkest(360)];
      report(seen);
    """
    seen = browse(out.read_text("utf-8").replace("</body>", f"<script>{PLAY}{script}</script></body>"))
    assert seen["before"][0] < 130 < 200 < seen["before"][1]
    assert seen["after"][1] < 130 < 200 < seen["after"][0]


def test_the_page_needs_nothing_else(scene_file: Path, browse: Browse) -> None:
    script = """report({ loaded: performance.getEntriesByType("resource").map((entry) => entry.name) });"""
    html = page_of(scene_file, script)
    assert browse(html) == {"loaded": []}
    assert "http" not in html


@pytest.mark.parametrize("ending", ["mp4", "webm"])
def test_the_video_plays_seeks_and_ends_in_a_browser(scene_file: Path, browse: Browse, ending: str) -> None:
    """At rest after the ball has left: the frames get longer, and the video lasts as long as it should."""
    out = scene_file.parent / f"run.{ending}"
    assert main(["simulate", str(scene_file), "-o", str(out), "--duration", "4", "--size", "320x240"]) == 0
    data = base64.b64encode(out.read_bytes()).decode()
    seen = browse(f"""<video id="video" muted src="data:video/{ending};base64,{data}"></video><script>
    const video = document.getElementById("video");
    const event = (name) => new Promise((done) => video.addEventListener(name, done, {{ once: true }}));
    (async () => {{
      await event("loadeddata");
      const seen = {{ size: [video.videoWidth, video.videoHeight], duration: video.duration }};
      video.currentTime = 3.3; await event("seeked"); seen.seeked = video.currentTime;
      video.currentTime = 0.5; await event("seeked");
      const c = document.createElement("canvas").getContext("2d");
      c.canvas.width = 320; c.canvas.height = 240;
      for (let k = 0; k < 100; k += 1) {{ // a busy browser shows the frame some time after it has sought it
        c.drawImage(video, 0, 0);
        seen.ball = [...c.getImageData(1.55 * 80, 1.5 * 80 + 20, 1, 1).data];
        if (seen.ball[3] && seen.ball[0] < 90) break; // drawn at all, and blue
        await new Promise((done) => setTimeout(done, 30));
      }}
      video.playbackRate = 4; video.play(); await event("ended");
      seen.end = video.currentTime;
      report(seen);
    }})();</script>""")
    assert seen["size"] == [320, 240]
    assert seen["duration"] == pytest.approx(4, abs=0.02)
    assert seen["seeked"] == pytest.approx(3.3, abs=0.02)
    assert seen["end"] == pytest.approx(4, abs=0.05)
    r, g, b, _ = seen["ball"]
    assert b > 200
    assert max(r, g) < 90
