// The words of the viewer, in the language of the description where the page brings them.

let known: Readonly<Record<string, string>> = {};

/** From now on in this language: English words and what they are there. */
export function speak(words: Readonly<Record<string, string>>): void {
  known = words;
}

export function say(english: string): string {
  return known[english] ?? english;
}
