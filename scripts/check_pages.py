#!/usr/bin/env python3
"""Looks at the pages that the program writes as a reader does, in Chromium without a window.

    scripts/check_pages.py target/debug/optimize

A small study and a recorded trial, whose space, robot and phase have names that would do harm if
a page let them; light and dark, desktop and phone. No word on the console, no request, nothing
wider than the screen; hover, click, keys, film. Ends with an error at the first thing that is
not so. Needs Chromium; nothing is fetched.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

from browser import Browser

ROOT = Path(__file__).resolve().parent.parent
EVIL = """</title><script>window.harmed=1</script><img src=x onerror=harmed=1>"'"""
# The ratio of contrast of two colours (WCAG 2.1, 1.4.11).
CONTRAST = """(a, b) => { const light = (c) => { const [r, g, b] = c.match(/[\\d.]+/g).map((v) => { v /= 255;
  return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const [x, y] = [light(a), light(b)]; return (Math.max(x, y) + 0.05) / (Math.min(x, y) + 0.05); }"""


def harmful(folder, source, name):
    """A copy of a shipped file with a harmful name in place of this one."""
    text = (ROOT / source).read_text().replace(f'name = "{name}"', f"name = '''{EVIL}'''", 1)
    file = folder / Path(source).name
    file.write_text(text)
    return file


def make(program, folder):
    """The report of a study with a film in it, and a replay."""
    space, robot = harmful(folder, "spaces/infill.toml", "infill"), harmful(folder, "robots/servo.toml", "servo")
    task, study, replay = harmful(folder, "tasks/usb.toml", "back"), folder / "study", folder / "replay.html"

    def run(*arguments):
        subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)

    run("--task", task, "--space", space, "--robot", robot, "--engine", "fake", "--budget", 40,
        "--no-cache", "--quiet", "--out", study)
    run("trial", "--task", task, "--robot", robot, "--density", 20, "--direction", 10, "--record", replay)
    # Where a study keeps its films; the fake engine makes none.
    (study / "replay").mkdir(exist_ok=True)
    (study / "replay" / "1-positive.html").write_bytes(replay.read_bytes())
    run("report", study)
    return study / "report.html", replay


def check(holds, what):
    if not holds:
        raise SystemExit(f"scripts/check_pages.py: {what}")


def whole(page, where):
    """Nothing said, asked for, run, or cut off."""
    check(not page.problems, f"{where}: {page.problems}")
    check(not page.js("window.harmed"), f"{where}: a name has run as a script")
    check(page.js("document.title").startswith(("usb", EVIL[:8])), f"{where}: the title is {page.js('document.title')}")
    check(page.js("document.documentElement.scrollWidth <= innerWidth"), f"{where}: wider than the screen")


def surface(page, where):
    """The recommended mark is seen on what is about it; hover, click and keys choose."""
    seen = page.js(f"""(() => {{ const contrast = {CONTRAST}, best = document.querySelector("#surface .best");
        const [halo, ring] = [".halo", ".ring"].map((name) => getComputedStyle(best.querySelector(name)).fill);
        return Math.min(...[...document.querySelectorAll("#surface rect")].map((cell) => {{
          const about = getComputedStyle(cell).fill;
          return Math.max(contrast(halo, about), contrast(ring, about)); }})); }})()""")
    check(seen >= 3, f"{where}: the best mark has a contrast of {seen:.1f} to 1")
    page.hover("#surface .mark:not(.best) .core")
    tip = page.js('document.querySelector("#tip").hidden ? "" : document.querySelector("#tip").textContent')
    check("evaluation" in tip and "infill density" in tip, f"{where}: hover says {tip!r}")
    page.click("#bars .mark:not(.best)")
    chosen = page.js('document.querySelector("#selected").textContent')
    check("(recommended)" not in chosen and page.js('document.querySelectorAll(".chosen").length') >= 3,
          f"{where}: a click on a bar chose {chosen!r}")
    page.js('document.querySelector("#explore").focus()')
    page.key("ArrowRight", 39)
    check(page.js('document.querySelector("#selected").textContent') != chosen, f"{where}: the arrow key chose nothing")


def film(page, where):
    """Opens in a frame that reaches nothing outside, and closes by its button and by Escape."""
    check(page.js('document.querySelector("#film").sandbox.value') == "allow-scripts", f"{where}: the frame is open")
    page.click("button[data-film]")
    page.wait('"ready" in document.querySelector("#player").dataset')
    check(page.js('document.querySelector("#film").contentDocument') is None, f"{where}: the film reaches the page")
    page.rest()
    page.key("Escape", 27)
    page.wait('!document.querySelector("#player").open')
    page.click("button[data-film]")
    page.wait('document.querySelector("#player").open')
    page.click("#close")
    check(not page.js('document.querySelector("#player").open'), f"{where}: the film does not close")


def play(page, where):
    """The clock runs while it plays."""
    clock = 'document.querySelector("#clock").textContent'
    page.wait(clock)
    before = page.js(clock)
    page.click("#play")
    page.wait(f"{clock} !== {before!r}")
    page.click("#play")


def scrub(page, where):
    """At the end the outcome stands there, and something is drawn."""
    page.js("""(() => { const time = document.querySelector("#time"); time.value = time.max;
        time.dispatchEvent(new Event("input")); })()""")
    page.rest()
    outcome = page.js('document.querySelector("#outcome0").textContent')
    check(outcome == "inserted", f"{where}: the outcome is {outcome!r}")
    colours = page.js(f"""(() => {{ const canvas = document.querySelector("canvas"), gl = canvas?.getContext("webgl");
        if (!gl) return 9;
        const pixels = new Uint8Array(4 * canvas.width * canvas.height);
        gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return new Set(new Uint32Array(pixels.buffer)).size; }})()""")
    check(colours > 5, f"{where}: nothing is drawn")


def main(program):
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        report, replay = make(program, Path(folder))
        for dark in [False, True]:
            for width in [1280, 390]:
                where = f"{'dark' if dark else 'light'}, {width} px"
                page = browser.open(report, width, 900, dark)
                surface(page, f"report, {where}")
                film(page, f"report, {where}")
                whole(page, f"report, {where}")
                page.close()
                page = browser.open(replay, width, 900, dark)
                play(page, f"replay, {where}")
                scrub(page, f"replay, {where}")
                whole(page, f"replay, {where}")
                page.close()
    print("the pages are whole: light and dark, desktop and phone")


if __name__ == "__main__":
    main(sys.argv[1])
