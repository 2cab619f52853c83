// The map of stability over one or two parameters with ranges, others at numbers.

import { make } from "./elements.js";
import { Job } from "./job.js";
import type { Model } from "./model.js";
import type { Told } from "./seam.js";
import { wordsOf } from "./server.js";

interface Axis {
  name: HTMLSelectElement;
  low: HTMLInputElement;
  high: HTMLInputElement;
  row: HTMLElement;
}

/** What a map may be over: parameters and symbols of the notation, as they are written. */
function namesOf(model: Model): string[] {
  const sections = model.understood?.tree?.children ?? [];
  const names = ["notation", "parameters"].flatMap((key) => {
    const section = sections.find((child) => child.path.length === 1 && child.path[0] === key);
    return (section?.children ?? []).map((child) => (section?.kind === "mapping" ? String(child.path.at(-1)) : (child.source ?? "").trim()));
  });
  return names.filter((name) => /^[A-Za-z]\w*$/.test(name));
}

function axis(key: string, words: string, optional: boolean): Axis {
  const name = make("select", { id: `map-${key}`, "aria-label": words });
  const low = make("input", { size: 6, value: "0", "aria-label": `${words}: from` });
  const high = make("input", { size: 6, value: "1", "aria-label": `${words}: to` });
  if (optional) name.append(make("option", { value: "" }, "(none)"));
  return { name, low, high, row: make("div", { class: "row" }, make("label", { for: `map-${key}` }, words), name, " from ", low, " to ", high) };
}

function given(text: string): Record<string, string> | null {
  const found: Record<string, string> = {};
  for (const part of text.split(/[,;\s]+/).filter(Boolean)) {
    const [name, value, more] = part.split("=");
    if (!name || !value || more !== undefined) return null;
    found[name] = value;
  }
  return found;
}

export function mapping(model: Model): HTMLElement {
  const x = axis("x", "Across", false);
  const y = axis("y", "Upwards", true);
  const set = make("input", { id: "map-set", size: 28, placeholder: "p1=2/5, p2=1/5" });
  const said = make("p", { role: "status" });
  const place = make("div", { class: "map-place" });
  const button = make("button", { type: "button", id: "map-begin", click: () => void begin() }, "Draw the map");
  const job = new Job(model, hear, () => void begin());

  function names(): void {
    const all = namesOf(model);
    for (const one of [x, y]) {
      const before = one.name.value;
      const options = all.map((name) => make("option", { value: name }, name));
      if (one === y) options.unshift(make("option", { value: "" }, "(none)"));
      one.name.replaceChildren(...options);
      if (all.includes(before)) one.name.value = before;
    }
    button.disabled = all.length === 0;
  }

  async function begin(): Promise<void> {
    const values = given(set.value);
    if (values === null) {
      said.textContent = "Values are written as  p1=2/5, p2=1/5";
      return;
    }
    const range = (one: Axis): object => ({ name: one.name.value, low: one.low.value.trim(), high: one.high.value.trim() });
    said.textContent = "Begun …";
    place.replaceChildren();
    try {
      await job.begin("map", { x: range(x), ...(y.name.value ? { y: range(y) } : {}), set: values });
    } catch (failure) {
      said.textContent = wordsOf(failure);
    }
  }

  function hear(told: Told): void {
    if (told.kind === "map") {
      const image = String(told["image"]);
      const about = y.name.value ? `${x.name.value} and ${y.name.value}` : x.name.value;
      if (image.startsWith("data:image/png;base64,")) place.replaceChildren(make("img", { src: image, alt: `Map of stability over ${about}` }));
      said.textContent = ((told["words"] as string[] | undefined) ?? []).join("; ") || `Over ${about}, of the text as it was then.`;
    } else if (told.kind === "progress") said.textContent = `${String(told["words"])} …`;
    else if (told.kind === "failed" || told.kind === "cancelled") said.textContent = `No map: ${String(told["words"])}.`;
  }

  model.on("view", names);
  return make(
    "details",
    { class: "mapping" },
    make("summary", {}, "Map of stability"),
    x.row,
    y.row,
    make("div", { class: "row" }, make("label", { for: "map-set" }, "Other values "), set, button),
    said,
    place,
  );
}
