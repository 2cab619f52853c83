// What the server wrote as HTML becomes elements of this page: copied by a list of what is known, and nothing else.
// A parsed document that is shown nowhere runs no script and loads nothing; from it only names on the list are taken.

const HTML = "http://www.w3.org/1999/xhtml";
const MATHML = "http://www.w3.org/1998/Math/MathML";
const SVG = "http://www.w3.org/2000/svg";

const words = (text: string): Set<string> => new Set(text.split(" "));

const ELEMENTS: Record<string, Set<string>> = {
  [HTML]: words(
    "p h2 h3 h4 ul ol li dl dt dd div span strong em i b code small sub sup table thead tbody tr th td caption details summary figure figcaption section br pre",
  ),
  [MATHML]: words(
    "math mrow mi mn mo ms mtext mspace msub msup msubsup mfrac msqrt mroot mover munder munderover mtable mtr mtd mpadded mphantom mstyle",
  ),
  [SVG]: words("svg g defs marker path rect line circle text title desc foreignObject"),
};

const ATTRIBUTES: Record<string, Set<string>> = {
  [HTML]: words("class scope colspan rowspan data-latex data-wolfram data-python"),
  [MATHML]: words(
    "class display separator stretchy form fence accent lspace rspace width mathvariant symmetric data-latex data-wolfram data-python",
  ),
  [SVG]: words(
    "class viewBox width height x y x1 y1 x2 y2 d rx r cx cy role aria-label markerWidth markerHeight refX refY markerUnits orient",
  ),
};

/** A drawing's own arrow head, and lines that end in it: no other name, and no other address. */
function isTip(element: Element, name: string, value: string): boolean {
  return (
    element.namespaceURI === SVG &&
    ((element.localName === "marker" && name === "id" && value === "tip") ||
      (/^marker-(start|end)$/.test(name) && value === "url(#tip)"))
  );
}

/** Links of the report lead to its own sections; here they are words that name them. */
function linked(element: Element): string | null {
  const to = element.getAttribute("href") ?? "";
  return element.namespaceURI === HTML && element.localName === "a" && /^#[a-z0-9-]+$/.test(to) ? to.slice(1) : null;
}

function copied(from: Node, follow: (section: string) => void): Node | null {
  if (from.nodeType === Node.TEXT_NODE) return document.createTextNode(from.nodeValue ?? "");
  if (!(from instanceof Element)) return null;
  const space = from.namespaceURI ?? "";
  const section = linked(from);
  let made: Element | DocumentFragment;
  if (section !== null) {
    made = document.createElement("button");
    (made as HTMLButtonElement).type = "button";
    made.className = "link";
    made.addEventListener("click", () => follow(section));
  } else if (ELEMENTS[space]?.has(from.localName)) {
    made = document.createElementNS(space, from.localName);
    for (const { name, value } of from.attributes) {
      if (ATTRIBUTES[space]?.has(name) || isTip(from, name, value)) made.setAttribute(name, value);
    }
  } else if (from.localName === "script" || from.localName === "style") {
    return null;
  } else made = document.createDocumentFragment();
  for (const child of from.childNodes) {
    const copy = copied(child, follow);
    if (copy !== null) made.append(copy);
  }
  return made;
}

/** Elements of this page that say what a fragment of the server's says. */
export function sanitised(html: string, follow: (section: string) => void): DocumentFragment {
  const parsed = new DOMParser().parseFromString(html, "text/html");
  const found = document.createDocumentFragment();
  for (const child of parsed.body.childNodes) {
    const copy = copied(child, follow);
    if (copy !== null) found.append(copy);
  }
  return found;
}
