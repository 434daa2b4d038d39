"""The comparison report in a real browser: opens without errors, shows the values of the EXRs, answers sliders, keys and fingers, injects nothing.

Usage: browser.py PROGRAM, where PROGRAM is chiaro_tests_report, which makes the pages. Needs chromium, chromium-driver and python3-selenium
(sh tools/setup.sh browser); prints "SKIPPED: ..." and leaves where they are absent.
"""

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    print("SKIPPED: python3-selenium is not installed (sh tools/setup.sh browser)")
    sys.exit(0)

failures = 0


def check(what, ok, *facts):
    global failures
    print("ok  " if ok else "FAIL", what, *([] if ok else facts))
    failures += not ok


def same(shown, value, mantissa=10):
    """A value of the page (text) and one of the EXR: equal to half precision, or to the bits that the page announces."""
    if value is None:
        return shown in ("NaN", "Infinity", "-Infinity")
    return math.isclose(float(shown), value, rel_tol=2 ** -(mantissa + 1) + (2**-11 if mantissa < 10 else 0), abs_tol=2 ** -(mantissa + 15))


class Browser:
    def __init__(self):
        options = webdriver.ChromeOptions()
        options.binary_location = shutil.which("chromium")
        arguments = ["--headless=new", "--disable-gpu", "--hide-scrollbars", "--disable-dev-shm-usage", "--window-size=1440,900"]
        for argument in arguments + (["--no-sandbox"] if os.geteuid() == 0 else []):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)

    def open(self, page, width=1440, height=900, dark=False):
        command = self.driver.execute_cdp_cmd
        command("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})
        command("Emulation.setTouchEmulationEnabled", {"enabled": width < 500, "maxTouchPoints": 2 if width < 500 else 1})
        scheme = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        command("Emulation.setEmulatedMedia", {"features": scheme})
        self.driver.get(page.as_uri())
        ready = """return document.documentElement.dataset.ready === 'yes' &&
            ![...document.querySelectorAll('.message')].some(m => m.textContent.startsWith('decoding'))"""
        self.wait(lambda: self.run(ready), "the page comes up: " + page.name)

    def run(self, script, *values):
        return self.driver.execute_script(script, *values)

    def wait(self, condition, what, seconds=30):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if condition():
                return True
            time.sleep(0.03)
        check(what, False, "not within", seconds, "s")
        return False

    def settle(self):
        """Until two frames have been drawn."""
        self.driver.execute_async_script("""const done = arguments[0];
            requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 0)));""")

    def press(self, keys, target="body"):
        self.run("document.querySelector(arguments[0]).focus()", target)
        ActionChains(self.driver).send_keys(keys).perform()
        self.settle()

    def slide(self, name, value):
        self.run("""const s = document.getElementById(arguments[0]);
            s.value = arguments[1];
            s.dispatchEvent(new Event('input', {bubbles: true}));""", name, value)
        self.settle()

    def click(self, selector):
        self.driver.find_element(By.CSS_SELECTOR, selector).click()
        self.settle()

    def pixels(self, index=0):
        """A number for what a canvas shows, and its mean brightness."""
        return self.run("""const c = document.querySelectorAll('#stage canvas')[arguments[0]], d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
            let hash = 0, sum = 0;
            for (let i = 0; i < d.length; i += 4) { hash = (hash * 31 + d[i] + 3 * d[i + 1] + 7 * d[i + 2]) % 1000003; sum += d[i + 1]; }
            return [hash, sum / (d.length / 4)];""", index)

    def aim(self, x, y):
        self.run("""for (const [name, v] of [['x', arguments[0]], ['y', arguments[1]]]) { const f = document.getElementById('pixel-' + name); f.value = v;
            f.dispatchEvent(new Event('change', {bubbles: true})); }""", x, y)
        self.settle()

    def read_out(self):
        return self.run("""return [...document.querySelectorAll('#values tr')].map(
            r => [...r.querySelectorAll('td[data-channel]')].map(c => c.dataset.value));""")

    def errors(self):
        """Everything on the console but what this test's own reading of canvases causes."""
        return [e["message"] for e in self.driver.get_log("browser") if "getImageData" not in e["message"]]


def values(browser, page, expected):
    browser.open(page)
    check("no console messages", (found := browser.errors()) == [], found)
    wrong = 0
    for x, y in [(0, 0), (95, 63), (20, 10), (20, 11), (48, 12), (33, 40), (7, 59)]:
        browser.aim(x, y)
        for shown, picture in zip(browser.read_out(), expected["pictures"]):
            i = 3 * (y * 96 + x)
            wrong += sum(not same(shown[c], picture[i + c]) for c in range(3))
    check("the read-out has the EXR's values in all pictures", wrong == 0, wrong)
    browser.aim(20, 10)
    check("NaN is called NaN", browser.read_out()[0][0] == "NaN", browser.read_out()[0])
    check("pixels that are not finite are counted", "2 pixels not finite" in browser.run("return document.querySelector('.odd').textContent"))
    green = browser.run("""const c = document.querySelector('#stage canvas'), s = c.width / 96;
        return [...c.getContext('2d').getImageData(Math.floor(20.5 * s), Math.floor(10.5 * s), 1, 1).data.slice(0, 3)];""")
    check("and have their colour", green == [57, 255, 20], green)
    shown = browser.run("""const c = document.querySelectorAll('#stage canvas')[3], s = c.width / 96;
        return c.getContext('2d').getImageData(Math.floor(33.5 * s), Math.floor(40.5 * s), 1, 1).data[1];""")
    v = expected["pictures"][3][3 * (40 * 96 + 33) + 1] * 2**-0.5
    srgb = round(255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055))
    check("colours are those of the sRGB curve at the exposure", abs(shown - srgb) <= 1, shown, srgb)


def reduced(browser, page, expected):
    """A page with little room: pictures equal within the announced bits, maps are the means of what they stand for."""
    browser.open(page)
    data = browser.run("return JSON.parse(document.getElementById('data').textContent)")
    mantissa, f = data["mantissa"], data["mapFactor"]
    check("pictures keep their size, maps and bits are reduced", data["factor"] == 1 and f > 1 and 5 <= mantissa < 10, mantissa, f)
    check("and the page says so", f"{mantissa} bits of mantissa" in browser.run("return document.getElementById('reduced').textContent"))
    wrong = []
    for number, each in enumerate(expected["maps"]):
        browser.press("m")
        browser.wait(lambda: browser.run("return [...document.querySelectorAll('.message')].every(m => !m.textContent.startsWith('decoding'))"), "the map")
        for x, y in [(0, 0), (95, 63), (48, 12), (33, 40), (7, 59)]:
            browser.aim(x, y)
            shown = browser.read_out()
            for values, picture in zip(shown, expected["pictures"]):
                i = 3 * (y * 96 + x)
                wrong += [(x, y, values[c], picture[i + c]) for c in range(3) if not same(values[c], picture[i + c], mantissa)]
            block = [each["values"][v * 96 + u] for v in range(y // f * f, y // f * f + f) for u in range(x // f * f, x // f * f + f)]
            mean = min(each["high"], max(each["low"], sum(block) / len(block)))
            if abs(float(shown[0][4]) - mean) > 0.51 * (each["high"] - each["low"]) / (2 * data["mapSteps"]):
                wrong.append((x, y, number, shown[0][4], mean))
    check("values are equal within the announced bits, maps are means", wrong == [], wrong[:5])
    check("no console messages", (found := browser.errors()) == [], found)


def injection(browser, expected):
    check("nothing is injected", browser.run("return window.injected") is None)
    check("no element comes from data", browser.run("return document.querySelectorAll('#title *, #note-list li *, .tile img, b').length") == 0)
    check("a hostile title is text", browser.run("return document.getElementById('title').textContent") == expected["hostile"])


def controls(browser):
    start = browser.pixels()
    browser.slide("exposure", 2)
    bright = browser.pixels()
    check("the exposure slider brightens", bright[1] > start[1] + 5, start, bright)
    browser.click("#exposure-reset")
    check("and is reset", browser.pixels() == start)
    browser.press("e")
    check("E brightens", browser.pixels()[1] > start[1])
    browser.press("0")
    check("0 resets", browser.pixels() == start)
    browser.press("d")
    automatic = browser.pixels()
    check("D shows the difference", automatic != start and browser.run("return !document.getElementById('scale-bar').hidden"))
    browser.slide("scale", 6)
    check("the scale slider changes it", browser.pixels() != automatic)
    browser.press("m")
    flip = browser.pixels()
    browser.press("m")
    check("M goes through the maps", browser.pixels() != flip and flip != automatic)
    browser.press("p")
    browser.press("l")
    check("L shows a layer", browser.pixels() != start and browser.run("return document.getElementById('layer').value") == "bounce 1")
    browser.press("l")
    browser.press("s")
    check("S shows one picture", browser.run("return document.querySelectorAll('#stage canvas').length") == 1)
    one = browser.pixels()
    browser.press("f")
    check("F flips", browser.pixels() != one)
    browser.press("f")
    check("and back", browser.pixels() == one)
    browser.press("2")
    check("a number picks A", browser.run("return document.getElementById('pick-a').value") == "1" and browser.pixels() != one)
    browser.press("1")
    browser.press("w")
    wiped = browser.pixels()
    browser.slide("wipe", 0.2)
    check("the wipe slider moves the border", browser.pixels() != wiped)
    browser.press("]")
    check("] moves it too", abs(float(browser.run("return document.getElementById('wipe').value")) - 0.25) < 1e-6)
    browser.press("g")
    check("G is as at the start", browser.pixels() == start)
    browser.press("+")
    zoomed = [browser.pixels(i) for i in range(2)]
    browser.press("h")
    check("+ and H zoom and pan all pictures", all(z != browser.pixels(i) for i, z in enumerate(zoomed)) and zoomed[0] != start)
    browser.press("z")
    check("Z shows everything", browser.pixels() == start)
    browser.aim(50, 30)
    browser.press(Keys.ARROW_RIGHT + Keys.ARROW_DOWN, "#stage")
    where = browser.run("return [document.getElementById('pixel-x').value, document.getElementById('pixel-y').value]")
    check("arrows move the crosshair", where == ["51", "31"], where)
    browser.wait(lambda: browser.run("return document.getElementById('spoken').textContent").startswith("pixel 51, 31"), "the read-out is spoken")
    browser.press("?")
    check("? opens the help", browser.run("return document.getElementById('help').open"))
    browser.press(Keys.ESCAPE)
    check("Escape closes it", not browser.run("return document.getElementById('help').open"))
    unnamed = browser.run("""return [...document.querySelectorAll('button, select, input')]
        .filter(e => !(e.textContent.trim() || e.ariaLabel || (e.labels && e.labels.length))).map(e => e.outerHTML);""")
    check("every control has a name", unnamed == [], unnamed)
    check("no console messages after all that", (found := browser.errors()) == [], found)


def pointers(browser):
    stage = browser.driver.find_elements(By.CSS_SELECTOR, "#stage .frame")
    ActionChains(browser.driver).move_to_element(stage[1]).perform()
    browser.settle()
    check("hovering reads out", browser.run("return document.getElementById('pixel-x').value") in ("47", "48", "49"))
    before = browser.pixels(2)
    ActionChains(browser.driver).double_click(stage[0]).perform()
    browser.settle()
    zoomed = browser.pixels(2)
    check("a double click zooms all pictures", zoomed != before)
    ActionChains(browser.driver).drag_and_drop_by_offset(stage[1], 60, 30).perform()
    browser.settle()
    check("dragging moves all pictures", browser.pixels(2) != zoomed)
    browser.press("z")


def looks(browser, page):
    ground = "return getComputedStyle(document.body).backgroundColor"
    browser.open(page, dark=True)
    dark = browser.run(ground)
    browser.press("t")
    light = browser.run(ground)
    browser.open(page, dark=True)
    check("the choice is remembered", browser.run(ground) == light)
    browser.press("t")
    check("and forgotten when it is the system's again", browser.run("return localStorage.length") == 0 and browser.run(ground) == dark)
    deny = "Object.defineProperty(window, 'localStorage', {get() { throw new DOMException('denied', 'SecurityError'); }});"
    denied = browser.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": deny})
    browser.open(page, dark=True)
    browser.press("t")
    check("T works where nothing may be remembered", browser.run(ground) == light and (found := browser.errors()) == [])
    browser.driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", denied)
    check("dark by the system's wish, light by T", dark == "rgb(20, 21, 23)" and light == "rgb(251, 251, 250)", dark, light)
    for width in (390, 320, 768):
        browser.open(page, width, 844)
        for key in "gswd":
            browser.press(key)
            seen = browser.run("return [document.documentElement.scrollWidth, innerWidth]")
            check(f"no sideways scrolling at {width}, {key}", seen[0] <= width, seen)
    browser.open(page, 390, 844)
    frame = browser.run("""const frame = document.querySelector('.frame');
        scrollTo({top: scrollY + frame.getBoundingClientRect().top - 100, behavior: 'instant'});
        const box = frame.getBoundingClientRect();
        return [box.left + box.width / 2, box.top + box.height / 2];""")
    start = browser.pixels()

    def touch(kind, *offsets):
        points = [{"x": frame[0] + d, "y": frame[1], "id": i} for i, d in enumerate(offsets)]
        browser.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", -10, 10)
    for d in (20, 30, 40):
        touch("touchMove", -d, d)
    touch("touchEnd")
    browser.settle()
    check("two fingers zoom", browser.pixels() != start)


def main():
    missing = [name for name in ("chromium", "chromedriver") if not shutil.which(name)]
    if missing:
        print(f"SKIPPED: no {' and no '.join(missing)} (sh tools/setup.sh browser)")
        return 0
    with tempfile.TemporaryDirectory(prefix="chiaro-browser-") as name:
        folder = Path(name)
        environment = dict(os.environ, CHIARO_REPORT_PAGE=name)
        subprocess.run([sys.argv[1], "--no-skip", "--test-case=page for the browser"], env=environment, check=True, stdout=subprocess.DEVNULL)
        expected = json.loads((folder / "expected.json").read_text())
        browser = Browser()
        try:
            browser.driver.set_script_timeout(30)
            values(browser, folder / "page.html", expected)
            injection(browser, expected)
            reduced(browser, folder / "reduced.html", expected)
            browser.open(folder / "page.html")
            browser.press("z")
            controls(browser)
            pointers(browser)
            looks(browser, folder / "page.html")
            for other in ("pixel.html", "black.html", "empty.html"):
                browser.open(folder / other)
                for key in "dswg+z":
                    browser.press(key)
                check(f"{other} works", (found := browser.errors()) == [], found)
        finally:
            browser.driver.quit()
    print("all passed" if failures == 0 else f"{failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
