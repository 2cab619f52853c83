// MathML from the server, copied element by element: what is not on the list is left out.

const SPACE = "http://www.w3.org/1998/Math/MathML";
const ELEMENTS = new Set(
  "math mrow mi mn mo mtext mspace mfrac msup msub msubsup msqrt mroot mover munder munderover mtable mtr mtd mstyle mpadded mphantom".split(" "),
);
const ATTRIBUTES = new Set(
  "display form stretchy separator width lspace rspace accent mathvariant columnalign fence minsize maxsize".split(" "),
);

function copied(from: Element): Element | null {
  if (!ELEMENTS.has(from.localName)) return null;
  const to = document.createElementNS(SPACE, from.localName);
  for (const { name, value } of from.attributes) if (ATTRIBUTES.has(name)) to.setAttribute(name, value);
  for (const child of from.childNodes) {
    if (child.nodeType === Node.TEXT_NODE) to.append(child.textContent ?? "");
    else if (child.nodeType === Node.ELEMENT_NODE) {
      const inside = copied(child as Element);
      if (inside) to.append(inside);
    }
  }
  return to;
}

/** The formula, or null where the text is none. `source` may be a `<math>` or only what stands in one. */
export function formula(source: string): Element | null {
  const whole = source.trimStart().startsWith("<math") ? source : `<math>${source}</math>`;
  const parsed = new DOMParser().parseFromString(whole, "application/xml");
  return parsed.querySelector("parsererror") ? null : copied(parsed.documentElement);
}
