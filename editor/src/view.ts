// The viewer of `mbsym view`: picture, motion, modes and equilibria of one system, in one file without a server.

import { Viewer } from "./picture/viewer.js";
import type { Equilibria, Modes, Motion, Picture } from "./picture/types.js";
import { speak } from "./picture/words.js";
import "./view.css";

interface Data {
  /** What English words are in the language of the description. */
  words: Record<string, string>;
  picture: Picture;
  motion: Motion | null;
  modes: Modes | Why | null;
  equilibria: Equilibria | Why | null;
}

/** In place of what cannot be had. */
interface Why {
  why: string;
}

const host = document.getElementById("viewer");
const source = document.getElementById("picture-data");
if (host && source) {
  const data = JSON.parse(source.textContent ?? "") as Data;
  speak(data.words);
  const viewer = new Viewer(host);
  viewer.show(data.picture);
  const { equilibria, modes } = data;
  if (equilibria && "why" in equilibria) viewer.note("equilibria", equilibria.why);
  else if (equilibria) viewer.showEquilibria(equilibria);
  if (modes && "why" in modes) viewer.note("modes", modes.why);
  else if (modes) viewer.showModes(modes);
  if (data.motion) viewer.showMotion(data.motion);
  Object.assign(globalThis, { mbsymViewer: viewer });
}
