// The words of the viewer, in the language of the description where the page brings them.

let known: Readonly<Record<string, string>> = {};

/** From now on in this language: English words and what they are there. */
export function speak(words: Readonly<Record<string, string>>): void {
  known = words;
}

/** A word or sentence, with what stands in its gaps: "Mode [[number]]". */
export function say(english: string, gaps: Readonly<Record<string, string | number>> = {}): string {
  return (known[english] ?? english).replace(/\[\[(\w+)\]\]/g, (_, name: string) => String(gaps[name] ?? ""));
}
