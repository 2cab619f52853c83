// While a button of the mouse is down nothing may move under it: what is pressed would not be what is let go, and the
// click would be lost.

let pressed = false;
let waiting: (() => void)[] = [];

document.addEventListener("pointerdown", () => (pressed = true), true);
for (const event of ["pointerup", "pointercancel", "dragend"]) {
  document.addEventListener(event, () => {
    pressed = false;
    const now = waiting;
    waiting = [];
    // After the click that this becomes.
    window.setTimeout(() => now.forEach((act) => act()));
  }, true);
}

/** Now, or as soon as nothing is held down. */
export function released(act: () => void): void {
  if (pressed) waiting.push(act);
  else act();
}
