"use strict";
// Opens and closes every folded formula at once; without scripts each still opens by itself.
const fold = document.getElementById("fold");
if (fold) {
  fold.hidden = false;
  fold.addEventListener("click", () => {
    const all = [...document.querySelectorAll("details")];
    const open = all.some((item) => !item.open);
    for (const item of all) item.open = open;
    fold.textContent = open ? fold.dataset.fold : fold.dataset.unfold;
  });
}
