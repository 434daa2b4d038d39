"""A baked scene in a stock three.js page in a real browser: it shows what chiaro renders, without a light and without code of ours.

Usage: bake_browser.py CHIARO [FOLDER], CHIARO the program. The environment variable CHIARO_THREE names the folder of an unpacked three.js
(npm pack three; tar xzf three-*.tgz; its folder `package`): nothing is downloaded here. Needs chromium, chromium-driver and
python3-selenium (sh tools/setup.sh browser). Prints "SKIPPED: ..." and leaves where something is absent. With FOLDER the pictures are kept.
"""

import functools
import http.server
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError:
    print("SKIPPED: python3-selenium is not installed (sh tools/setup.sh browser)")
    sys.exit(0)

SIZE = 192
PAGE = """<!doctype html><html><body style="margin:0">
<script type="importmap">{"imports": {"three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}</script>
<script type="module">
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
window.problem = null;
addEventListener('error', e => window.problem = String(e.message));
try {
    const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    renderer.setSize(SIZE, SIZE);
    document.body.appendChild(renderer.domElement);
    const gltf = await new GLTFLoader().loadAsync('/NAME');
    renderer.render(gltf.scene, gltf.cameras[0]);
    const grab = source => {
        const c = document.createElement('canvas');
        c.width = c.height = SIZE;
        const g = c.getContext('2d');
        g.drawImage(source, 0, 0);
        return g.getImageData(0, 0, SIZE, SIZE).data;
    };
    const image = new Image();
    image.src = '/reference.png';
    await image.decode();
    const a = grab(renderer.domElement), b = grab(image);
    // Means of 8 x 8 pixels: noise of single texels and pixels says nothing.
    const n = SIZE / 8, blocks = new Float64Array(n * n * 3);
    for (let y = 0; y < SIZE; ++y)
        for (let x = 0; x < SIZE; ++x)
            for (let c = 0; c < 3; ++c) {
                const i = 4 * (y * SIZE + x) + c;
                blocks[3 * ((y >> 3) * n + (x >> 3)) + c] += (a[i] - b[i]) / 64;
            }
    let sum = 0, bias = 0, far = 0;
    for (const d of blocks) {
        sum += Math.abs(d) / blocks.length;
        bias += d / blocks.length;
        far += (Math.abs(d) > 16) / blocks.length;
    }
    window.result = { difference: sum, bias, far, picture: renderer.domElement.toDataURL('image/png') };
} catch (e) { window.problem = String(e); }
</script></body></html>"""

failures = 0


def check(what, ok, *facts):
    global failures
    print("ok  " if ok else "FAIL", what, *facts)
    failures += not ok


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ["--headless=new", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                     "--hide-scrollbars"] + (["--no-sandbox"] if os.geteuid() == 0 else []):
        options.add_argument(argument)
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


def main():
    missing = [name for name in ("chromium", "chromedriver") if not shutil.which(name)]
    if missing:
        print(f"SKIPPED: no {' and no '.join(missing)} (sh tools/setup.sh browser)")
        return 0
    three = os.environ.get("CHIARO_THREE", "")
    if not (Path(three) / "build/three.module.js").is_file():
        print("SKIPPED: CHIARO_THREE does not name the folder of an unpacked three.js (npm pack three; tar xzf three-*.tgz)")
        return 0
    program = sys.argv[1]
    with tempfile.TemporaryDirectory(prefix="chiaro-bake-") as name:
        folder = Path(name)
        (folder / "three").symlink_to(Path(three).resolve())

        def run(*words):
            return subprocess.run([program, *words, "-q"], cwd=folder, check=True, capture_output=True, text=True).stdout

        exposure = json.loads(run("bake", "@cornell", "--size", "256", "--spp", "96", "-o", "map.glb", "--json"))["exposure"]
        run("bake", "@cornell", "--to", "vertex", "--density", "4", "--spp", "64", "-o", "vertex.gltf", "--exposure", str(exposure))
        run("render", "@cornell", "--size", f"{SIZE}x{SIZE}", "--spp", "128", "--exposure", str(exposure), "-o", "reference.png")
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=name))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        driver = browser()
        try:
            # In bytes of 255; blocks with the rim of the lamp are far apart. Vertices shade linearly over 25 cm what falls off faster.
            for scene, difference, far in (("map.glb", 1.5, 0.02), ("vertex.gltf", 2.5, 0.02)):
                (folder / "page.html").write_text(PAGE.replace("SIZE", str(SIZE)).replace("NAME", scene))
                driver.get(f"http://127.0.0.1:{server.server_port}/page.html")
                end = time.monotonic() + 60
                while time.monotonic() < end and not driver.execute_script("return window.result || window.problem"):
                    time.sleep(0.1)
                problem = driver.execute_script("return window.problem")
                result = driver.execute_script("return window.result")
                check(f"{scene} opens in a stock page", bool(result) and not problem, problem or "")
                if not result:
                    continue
                facts = {k: round(result[k], 4) for k in ("difference", "bias", "far")}
                check(f"{scene} shows what chiaro renders", result["difference"] < difference and result["far"] < far, facts)
                if len(sys.argv) > 2:
                    import base64
                    target = Path(sys.argv[2])
                    target.mkdir(parents=True, exist_ok=True)
                    (target / f"{scene}.png").write_bytes(base64.b64decode(result["picture"].split(",")[1]))
                    shutil.copy(folder / "reference.png", target)
        finally:
            driver.quit()
            server.shutdown()
    print("all passed" if failures == 0 else f"{failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
