"""The editor in a real browser: from a key to the complaints shown, a step of the arrow keys, the first results.

For the satellite of the paper and a chain of 50 bodies; the peer is the same machine drawing an empty frame.
Run: PYTHONPATH=tests:tests/browser python tests/bench/window_bench.py
"""

from __future__ import annotations

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
    print(f"  frame with the picture {frame:.0f} ms")


def main() -> None:
    with sync_playwright() as running, tempfile.TemporaryDirectory() as folder:
        chromium = running.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        measured(chromium, "satellite", (SYSTEMS / "satellite.yaml").read_text(encoding="utf-8"), Path(folder))
        measured(chromium, "chain of 50", chain(50), Path(folder))


if __name__ == "__main__":
    main()
