// What has to be decided but must not stand in the way: a change of the file from outside, a journal, a server away.

import { save } from "./commands.js";
import { make } from "./elements.js";
import type { Model } from "./model.js";

interface Offer {
  words: string;
  choices: { words: string; act: () => void }[];
}

const ANOTHER =
  "Another `mbsym edit` answers here now, which does not know this page: open the address that it has printed, or, to go on with " +
  "this text, copy it and paste it there. Nothing more is saved from here.";

export function bannersOf(model: Model): HTMLElement {
  const host = make("div", { class: "banners" });
  const shown = new Map<string, HTMLElement>();

  function close(kind: string): void {
    shown.get(kind)?.remove();
    shown.delete(kind);
  }

  function offer(kind: string, { words, choices }: Offer): void {
    close(kind);
    const banner = make(
      "div",
      { class: `banner ${kind}`, role: "alert" },
      make("span", {}, words),
      ...choices.map((choice) => make("button", { type: "button", click: () => { close(kind); choice.act(); } }, choice.words)),
    );
    shown.set(kind, banner);
    host.append(banner);
  }

  model.on("told", (told) => {
    if (told.kind !== "outside" || typeof told["text"] !== "string" || typeof told["digest"] !== "string") return;
    const { text, digest } = told as unknown as { text: string; digest: string };
    if (digest === model.file.digest || (digest !== "" && text === model.beingSaved)) return close("outside");
    const untouched = model.saved;
    if (digest === "") {
      // There is nothing left to be written over, and nothing to be loaded: from now on the text is a new file's.
      model.fileIsGone();
      model.say(`${model.file.name} is no longer there`);
      return offer("outside", {
        words: `${model.file.name} was deleted, renamed or moved away outside this page. The text stays here; saving writes the file again.`,
        choices: [{ words: "Save it again", act: () => void save(model) }, { words: "Close", act: () => undefined }],
      });
    }
    if (text === model.text) return model.fileIs(digest, text);
    // Until somebody decides the digest stays the old one: saving asks, and writes over nothing by itself.
    offer("outside", {
      words: untouched
        ? `${model.file.name} was changed outside this page.`
        : `${model.file.name} was changed outside this page, and there are unsaved changes here.`,
      choices: [
        { words: "Load it (undo brings this text back)", act: () => { model.fileIs(digest, text); model.replaceText(text); model.say("loaded from the file"); } },
        { words: "Keep this text", act: () => { model.fileIs(digest, text); model.say("kept; saving writes over the other text"); } },
      ],
    });
  });
  model.on("file", () => close("outside"));
  model.on("connection", (state) => {
    if (state === "there") return close("away");
    offer("away", {
      words: state === "another" ? ANOTHER : "The server does not answer: is `mbsym edit` still running? The text stays here; it is tried again every two seconds.",
      choices: [{ words: "Copy the text", act: () => void navigator.clipboard.writeText(model.text) }],
    });
  });
  const journal = model.file.journal;
  if (journal !== null && journal.text !== model.text) {
    offer("journal", {
      words: `There are changes of ${journal.written} that were never saved.`,
      choices: [
        { words: "Take them up (undo goes back)", act: () => { model.replaceText(journal.text); model.say("the unsaved changes are here again"); } },
        { words: "Leave them", act: () => model.say("the file is as it was saved") },
      ],
    });
  }
  return host;
}
