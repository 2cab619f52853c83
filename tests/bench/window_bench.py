"""The editor in a real browser: from a key to the complaints shown, a step of the arrow keys, the first results.

For the satellite of the paper and a chain of 50 bodies, and frames a second while all of these move; the peer is the
same machine drawing frames of a page that holds nothing.
Run: PYTHONPATH=tests:tests/browser python tests/bench/window_bench.py
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import yaml
from conftest import CHROMIUM
from playwright.sync_api import sync_playwright
from windows import OPTIONS, Window, serving

SYSTEMS = Path(__file__).parents[2] / "systems"
KEYS = 15


def chain(bodies: int) -> str:
    links = [
        {
            "name": f"link {i}",
            "attached to": f"link {i - 1}" if i > 1 else 0,
            "rotation": {"axes": [3], "angles": [f"q{i}"]},
            "mass": 1,
            "connection point": [0, -1 if i > 1 else 0, 0],
            "mass centre": [0, -1, 0],
        }
        for i in range(1, bodies + 1)
    ]
    return yaml.safe_dump({"mbsym": 1, "name": "Chain", "bodies": links}, sort_keys=False)


FRAME = """async () => {
  const begun = performance.now();
  for (let i = 0; i < 20; i += 1) await new Promise(requestAnimationFrame);
  return (performance.now() - begun) / 20;
}"""
STEPS = """async () => {
  const begun = performance.now();
  for (let i = 0; i < 40; i += 1)
    document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowDown', bubbles: true}));
  await new Promise(requestAnimationFrame);
  return (performance.now() - begun) / 40;
}"""

#: When the first and the last section come, in milliseconds after a key that changes the mass of the selected body.
CHANGED = """(entry, last) => {
  window.cameAt = null;
  const sections = document.querySelector('.sections');
  const begun = performance.now();
  new MutationObserver((all, me) => {
    for (const one of all)
      if (one.target.className === 'state' && one.target.textContent.endsWith(' s')) {
        window.cameAt ??= [performance.now() - begun, null];
        if (one.target.closest('.result').id === last) {
          window.cameAt[1] = performance.now() - begun;
          me.disconnect();
        }
      }
  }).observe(sections, { subtree: true, childList: true });
  entry.focus();
  entry.value = '3';
  entry.dispatchEvent(new Event('input', { bubbles: true }));
  entry.dispatchEvent(new Event('change', { bubbles: true }));
}"""


def measured(chromium: object, name: str, text: str, folder: Path) -> None:
    path = folder / f"{name}.yaml"
    path.write_text(text, encoding="utf-8")
    with serving(path) as address:
        page = chromium.new_page(viewport={"width": 1280, "height": 720})  # type: ignore[attr-defined]
        window = Window(page, path)
        begun = time.perf_counter()
        page.goto(address, wait_until="commit")
        page.locator("#result-1:not(.old)").wait_for(timeout=120_000)
        first = time.perf_counter() - begun
        page.locator("#result-summary:not(.old)").wait_for(timeout=120_000)
        whole = time.perf_counter() - begun
        window.open(address)
        frame = page.evaluate(FRAME)
        page.locator("#graph [role=treeitem]").first.focus()
        step = page.evaluate(STEPS)
        page.locator("#result-summary:not(.old)").wait_for(timeout=120_000)
        page.locator("#graph [role=treeitem]").last.click()
        page.locator("#form").get_by_label("Mass", exact=True).evaluate(CHANGED, "result-summary")
        window.until("window.cameAt?.[1]")
        again = page.evaluate("window.cameAt")
        page.locator(".cm-content").focus()
        window.press("Control+End")
        for _ in range(KEYS):
            window.typed("y")
            window.settled()
        took = page.evaluate("performance.getEntriesByName('mbsym:look').map(e => e.duration)")[-KEYS:]
        page.close()
    print(
        f"{name}: key to complaints {median(took):.0f} ms (largest {max(took):.0f}), arrow keys {step:.1f} ms a step,"
    )
    print(f"  from opening the page to the first formulas {first:.1f} s, to the last {whole:.1f} s,")
    print(f"  from a change of a mass to the first formulas {again[0]:.0f} ms, to the last {again[1]:.0f} ms,")
    print(f"  frame with the picture {frame:.0f} ms")


RATE = """async (count) => {
  const stamps = [];
  for (let i = 0; i <= count; i += 1) stamps.push(await new Promise(requestAnimationFrame));
  return 1000 * count / (stamps[count] - stamps[0]);
}"""
GRAVITY = "loads:\n- uniform gravity: {acceleration: 9.81, direction: [0, -1, 0]}\ninitial:\n"


def moving(chromium: object, bodies: int, folder: Path) -> None:
    """The picture of a chain that swings, five seconds of it again and again."""
    path, drawn = folder / "swinging.yaml", folder / "swinging.html"
    start = "".join(f"  q{i}: {{position: 0.05, velocity: 0}}\n" for i in range(1, bodies + 1))
    path.write_text(chain(bodies) + GRAVITY + start, encoding="utf-8")
    command = [sys.executable, "-m", "mbsym_cli", "view", str(path), "--time", "5", "--out", str(drawn), "--quiet"]
    subprocess.run(command, check=True)
    page = chromium.new_page(viewport={"width": 1280, "height": 720})  # type: ignore[attr-defined]
    empty = page.evaluate(RATE, 60)
    page.goto(drawn.as_uri())
    page.locator(".viewer-play", has_text="Pause").wait_for()
    page.evaluate(RATE, 60)  # drawn coarser, should that be needed
    rate = page.evaluate(RATE, 120)
    size = page.evaluate("(({width, height}) => [width, height])(document.querySelector('canvas'))")
    page.close()
    print(f"{bodies} bodies in motion: {rate:.0f} frames a second of {size[0]} x {size[1]}; nothing: {empty:.0f}")


def main() -> None:
    with sync_playwright() as running, tempfile.TemporaryDirectory() as folder:
        chromium = running.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        measured(chromium, "satellite", (SYSTEMS / "satellite.yaml").read_text(encoding="utf-8"), Path(folder))
        measured(chromium, "chain of 50", chain(50), Path(folder))
        moving(chromium, 50, Path(folder))


if __name__ == "__main__":
    main()
