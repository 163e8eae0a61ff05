#!/usr/bin/env python3
"""Tests the pages written by the program in headless Chromium.

    scripts/check_pages.py target/debug/optimize

Pages: a small study and a recorded trial with malicious names of space, robot and phase, a study
of thousands of designs, and a study in which no design inserts; light and dark, desktop and phone.
Checks: no console messages, no requests, no overflow, required parts of the first screen, contrast
and size of text, hover, click, keyboard, film. Exits with an error at the first failed check.
Needs Chromium; nothing is downloaded.
"""
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from browser import Browser

ROOT = Path(__file__).resolve().parent.parent
MALICIOUS = """</title><script>window.harmed=1</script><img src=x onerror=harmed=1>"'"""
# Contrast ratio of two colours (WCAG 2.1, 1.4.11).
CONTRAST = """(a, b) => { const light = (c) => { const [r, g, b] = c.match(/[\\d.]+/g).map((v) => { v /= 255;
  return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const [x, y] = [light(a), light(b)]; return (Math.max(x, y) + 0.05) / (Math.min(x, y) + 0.05); }"""


def renamed(folder, source, name):
    """Writes a copy of a shipped file with its name replaced by a malicious one; returns its path."""
    text = (ROOT / source).read_text().replace(f'name = "{name}"', f"name = '''{MALICIOUS}'''", 1)
    file = folder / Path(source).name
    file.write_text(text)
    return file


def create_pages(program, folder):
    """Creates the pages: reports of three studies, a replay; returns their paths."""
    space, robot = renamed(folder, "spaces/infill.toml", "infill"), renamed(folder, "robots/servo.toml", "servo")
    task, study, replay = renamed(folder, "tasks/usb.toml", "back"), folder / "study", folder / "replay.html"

    def run(*arguments):
        subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)

    run("--task", task, "--space", space, "--robot", robot, "--engine", "fake", "--budget", 40,
        "--no-cache", "--quiet", "--out", study)
    run("trial", "--task", task, "--robot", robot, "--density", 20, "--direction", 10, "--record", replay)
    # The folder for films of a study; the fake engine creates none.
    (study / "replay").mkdir(exist_ok=True)
    for end in ["positive", "negative"]:
        (study / "replay" / f"1-{end}.html").write_bytes(replay.read_bytes())
    run("report", study)
    many = folder / "many"
    fine = (ROOT / "spaces/infill.toml").read_text().replace("step = 1.0", "step = 0.25").replace("step = 1\n", "step = 0.25\n")
    (folder / "fine.toml").write_text(fine)
    run("--task", "usb", "--space", folder / "fine.toml", "--engine", "fake", "--optimizer", "sobol", "--budget", 5000,
        "--no-confirm", "--no-cache", "--quiet", "--out", many)
    tight = (ROOT / "tasks/usb.toml").read_text().replace("7.49", "5.90").replace("7.51", "5.90")
    (folder / "tight.toml").write_text(tight)
    stuck = subprocess.run([program, "--task", folder / "tight.toml", "--budget", "4", "--no-cache", "--quiet", "--out", folder / "stuck"],
                           capture_output=True, check=False)
    check(stuck.returncode == 1, "a study in which no design inserts ended without an error")
    return study / "report.html", replay, many / "report.html", folder / "stuck/report.html"


def check(condition, message):
    """Exits with the message unless the condition holds."""
    if not condition:
        raise SystemExit(f"scripts/check_pages.py: {message}")


def check_page(page, where):
    """Checks that there are no console messages, requests, names executed as scripts, or overflow."""
    check(not page.problems, f"{where}: {page.problems}")
    check(not page.js("window.harmed"), f"{where}: a name was executed as a script")
    check(page.js("document.title").startswith(("usb", MALICIOUS[:8])),
          f"{where}: the title is {page.js('document.title')}")
    check(page.js("document.documentElement.scrollWidth <= innerWidth"), f"{where}: wider than the screen")


def check_map(page, where):
    """Checks the contrast of the mark of the recommended design, and selection by hover, click and keyboard."""
    contrast = page.js(f"""(() => {{ const contrast = {CONTRAST}, best = document.querySelector("#surface .best");
        const [halo, ring] = [".halo", ".ring"].map((name) => getComputedStyle(best.querySelector(name)).fill);
        return Math.min(...[...document.querySelectorAll("#surface rect")].map((cell) => {{
          const about = getComputedStyle(cell).fill;
          return Math.max(contrast(halo, about), contrast(ring, about)); }})); }})()""")
    check(contrast >= 3, f"{where}: the recommended mark has a contrast of {contrast:.1f} to 1")
    check(page.js('document.querySelector("#designs").scrollWidth <= document.querySelector("#designs").clientWidth'),
          f"{where}: the table of designs is wider than the screen")
    page.hover("#surface .mark:not(.best) .core")
    tip = page.js('document.querySelector("#tip").hidden ? "" : document.querySelector("#tip").textContent')
    check("evaluation" in tip and "infill density" in tip, f"{where}: the tooltip is {tip!r}")
    selected = 'document.querySelector("#selected").textContent'
    page.click("#designs tbody tr:nth-child(3) td")
    chosen = page.js(selected)
    check("(recommended)" not in chosen and "optimize trial" in chosen and page.js('document.querySelectorAll(".chosen").length') == 2,
          f"{where}: a click on a row selected {chosen!r}")
    page.js('document.querySelector("#explore").focus()')
    page.key("ArrowRight", 39)
    check(page.js(selected) != chosen, f"{where}: the arrow key selected nothing")
    page.click("#selected .card:last-child button:last-child")
    page.click("#designs tbody tr:nth-child(2) td")
    check(page.js('document.querySelectorAll("#selected .card").length') == 2, f"{where}: two designs are not compared")
    colours = '[...document.querySelectorAll("#surface rect")].map((cell) => cell.getAttribute("fill")).join()'
    mean = page.js(colours)
    page.click("#shown input[value=sd]")
    check(page.js(colours) != mean, f"{where}: the standard deviation is not shown")
    check(page.js('document.querySelectorAll("#scale line").length') >= 3, f"{where}: the scale has no ticks")
    first = 'document.querySelector("#designs tbody tr:nth-child(2)").textContent'
    before = page.js(first)
    page.click("#designs th:nth-child(2) button")
    page.click("#designs th:nth-child(2) button")
    check(page.js(first) != before, f"{where}: the table is not sorted")


# Tests whether an element is fully visible on the first screen.
VISIBLE = """(selector) => { const e = document.querySelector(selector); if (!e) return false;
  const b = e.getBoundingClientRect(); return b.width > 0 && b.top + scrollY >= 0 && b.bottom + scrollY <= innerHeight; }"""
# The lowest contrast of text outside images, and this text.
LOWEST_CONTRAST = f"""(() => {{ const contrast = {CONTRAST};
  const under = (e) => {{ for (; e; e = e.parentElement) {{ const c = getComputedStyle(e).backgroundColor;
      if (/^rgb\\(/.test(c)) return c; }} return "rgb(255, 255, 255)"; }};
  const own = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
  return [...document.querySelectorAll("body *:not(script):not(style)")].filter((e) => own(e) && !e.closest("svg") && e.getClientRects().length)
    .map((e) => [contrast(getComputedStyle(e).color, under(e)), e.textContent.slice(0, 40)]).sort((a, b) => a[0] - b[0])[0]; }})()"""
# The height of the smallest rendered text, px, and this text.
SMALLEST_TEXT = """(() => { const own = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
  const size = (e) => { const px = parseFloat(getComputedStyle(e).fontSize), svg = e.closest("svg");
    return svg ? px * svg.getBoundingClientRect().width / svg.viewBox.baseVal.width : px; };
  return [...document.querySelectorAll("body *:not(script):not(style)")].filter((e) => own(e) && e.getClientRects().length && getComputedStyle(e).display !== "none")
    .map((e) => [size(e), e.textContent.slice(0, 40)]).sort((a, b) => a[0] - b[0])[0]; })()"""


def check_legibility(page, where, width):
    """Checks the contrast of text, and its size on a phone."""
    contrast, text = page.js(LOWEST_CONTRAST)
    check(contrast >= 4.5, f"{where}: {text!r} has a contrast of {contrast:.2f} to 1")
    height, text = page.js(SMALLEST_TEXT)
    check(width > 390 or height >= 11.95, f"{where}: {text!r} is {height:.1f} px high")


def check_first_screen(page, where, parts):
    """Checks that the first screen contains these parts without scrolling."""
    for part in parts:
        check(page.js(f"({VISIBLE})({part!r})"), f"{where}: {part} is not on the first screen")


def check_film(page, where):
    """Checks that the film is loaded in a sandboxed frame, and plays after one click."""
    check(page.js('document.querySelector("#film").sandbox.value') == "allow-scripts", f"{where}: the frame is not sandboxed")
    state = 'document.querySelector("#film").dataset.state'
    page.wait(f'{state} === "ready"')
    check(page.js('document.querySelector("#film").contentDocument') is None, f"{where}: the film has access to the page")
    page.click("button[data-film]")
    page.wait(f'{state} === "playing"')
    page.click("button[data-film='1']")
    page.wait(f'{state} === "playing" && document.querySelector("button[data-film=\'1\'").ariaPressed === "true"')
    page.wait_for_drawing()


def check_playback(page, where):
    """Checks that the clock advances during playback."""
    clock = 'document.querySelector("#clock").textContent'
    page.wait(clock)
    before = page.js(clock)
    page.click("#play")
    page.wait(f"{clock} !== {before!r}")
    page.click("#play")


def check_end(page, where):
    """Checks that the replay shows the outcome and a drawing at its end."""
    page.js("""(() => { const time = document.querySelector("#time"); time.value = time.max;
        time.dispatchEvent(new Event("input")); })()""")
    page.wait_for_drawing()
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
        report, replay, many, stuck = create_pages(program, Path(folder))
        for dark in [False, True]:
            for width in [1280, 390]:
                where = f"{'dark' if dark else 'light'}, {width} px"
                page = browser.open(report, width, 900, dark)
                if width == 1280:
                    check_first_screen(page, f"report, {where}", ["h1", ".trust", "#film", ".finger svg", ".next code"])
                check_film(page, f"report, {where}")
                check_map(page, f"report, {where}")
                check_legibility(page, f"report, {where}", width)
                check_page(page, f"report, {where}")
                page.close()
                page = browser.open(stuck, width, 900, dark)
                if width == 1280:
                    check_first_screen(page, f"stuck, {where}", ["h1", "img", ".next code"])
                text = page.js("document.body.textContent")
                check("No finger inserts" in text and "class" in text and "finger.stl" not in text,
                      f"stuck, {where}: {text[:200]}")
                check_legibility(page, f"stuck, {where}", width)
                check_page(page, f"stuck, {where}")
                page.close()
                page = browser.open(replay, width, 900, dark)
                check_playback(page, f"replay, {where}")
                check_end(page, f"replay, {where}")
                check_page(page, f"replay, {where}")
                page.close()
        size, began = many.stat().st_size, time.monotonic()
        page = browser.open(many)
        took = time.monotonic() - began
        check_page(page, "many designs")
        check(size < 1_000_000 and took < 2, f"many designs: {size} bytes, {took:.1f} s")
        page.close()
    print("all page checks passed: light and dark, desktop and phone")


if __name__ == "__main__":
    main(sys.argv[1])
