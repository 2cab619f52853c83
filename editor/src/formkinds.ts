// What kinds of loads, constraints, claims and shapes there are, and the fields of each: read from the schema of
// descriptions and from what the server tells of claims, so that no second list of them has to be kept.

import type { Model } from "./model.js";

export interface Field {
  /** The key it stands under; "": the value of the kind itself. */
  key: string;
  sort: "formula" | "text" | "choice" | "body" | "list" | "ends" | "pairs" | "turns" | "state";
  /** What it means, as the schema says it. */
  words: string;
  /** May be left out. */
  optional: boolean;
  choices?: string[];
  count?: number;
  /** What the two ends have beside their bodies. */
  end?: "point" | "axis";
}

export interface Kind {
  /** What it is called in a list of kinds. */
  words: string;
  /** The key, or for a claim the word, that says the kind. */
  key: string;
  fields: Field[];
}

interface Schema {
  type?: string | string[];
  enum?: unknown[];
  items?: Schema;
  minItems?: number;
  maxItems?: number;
  properties?: Record<string, Schema>;
  required?: string[];
  description?: string;
  $ref?: string;
  anyOf?: Schema[];
  /** Of a key with another spelling: it, where the other is not there. */
  allOf?: { then?: Schema }[];
  title?: string;
  /** The ways in which a kind is given, by their first keys; keys of other ways are forbidden. */
  dependentSchemas?: Record<string, Schema>;
  $defs?: Record<string, Schema>;
}

function refers(schema: Schema | undefined, name: string): boolean {
  return schema?.$ref === `#/$defs/${name}`;
}

function field(key: string, schema: Schema, optional: boolean): Field {
  const made = { key, words: schema.description ?? "", optional };
  const [many, items] = [schema.minItems === schema.maxItems ? schema.maxItems : undefined, schema.items];
  if (refers(schema, "vector")) return { ...made, sort: "list", count: 3 };
  if (refers(schema, "expression")) return { ...made, sort: "formula" };
  if (refers(items, "point")) return { ...made, sort: "ends", end: "point" };
  if (refers(items, "axis")) return { ...made, sort: "ends", end: "axis" };
  if (schema.type === "array" && many) return { ...made, sort: "list", count: many };
  if (schema.enum) return { ...made, sort: "choice", choices: [...new Set(schema.enum.map(String))] };
  if (schema.anyOf?.some((one) => one.type === "object")) return { ...made, sort: "state" };
  if (schema.properties?.["axes"]) return { ...made, sort: "turns" };
  if (schema.type === "object" && !schema.properties) return { ...made, sort: "pairs" };
  return { ...made, sort: refers(schema, "body name") ? "body" : "text" };
}

function definitions(model: Model): Record<string, Schema> {
  return (model.file.schema as Schema | null)?.$defs ?? {};
}

/** What a key of a body means, as the schema says it. */
export function meaning(model: Model, key: string): string {
  return definitions(model)["body"]?.properties?.[key]?.description ?? "";
}

/** Kinds of loads or constraints: `{kind: {key: value}}`. */
function wrapped(model: Model, definition: string): Kind[] {
  const kinds: Kind[] = [];
  const seen = new Set<string>();
  for (const [key, schema] of Object.entries(definitions(model)[definition]?.properties ?? {})) {
    // Other spellings of a kind mean the same.
    const same = JSON.stringify(schema);
    if (seen.has(same)) continue;
    seen.add(same);
    if (!schema.properties) {
      kinds.push({ words: key, key, fields: [field("", schema, false)] });
      continue;
    }
    const needed = [...(schema.required ?? []), ...(schema.allOf ?? []).flatMap((one) => one.then?.required ?? [])];
    const fields = Object.entries(schema.properties)
      .filter(([inner]) => inner !== "center")
      .map(([inner, one]) => field(inner, one, !needed.includes(inner)));
    const ways = Object.values(schema.dependentSchemas ?? {});
    const push = (words: string, own: Field[]): unknown => kinds.push({ words, key, fields: [...own.filter((one) => !one.optional), ...own.filter((one) => one.optional)] });
    if (ways.length === 0) push(key, fields);
    for (const way of ways) {
      const own = fields.filter((one) => !(one.key in (way.properties ?? {})));
      push(`${key}: ${way.title}`, own.map((one) => ({ ...one, optional: !way.required?.includes(one.key) })));
    }
  }
  return kinds;
}

function claims(model: Model): Kind[] {
  const known = definitions(model)["claim"]?.properties ?? {};
  const late = ["state", "tolerance", "digits", "as", "place"];
  return Object.entries(model.file.claims ?? {}).map(([word, { of, keys }]) => {
    const fields = keys.map((key): Field => {
      const made = field(key, known[key] ?? {}, late.includes(key));
      return key === "of" && of === "body" ? { ...made, sort: "body" } : made;
    });
    return { words: word, key: word, fields };
  });
}

function shapes(model: Model): Kind[] {
  const known = definitions(model)["body"]?.properties?.["shapes"]?.items?.properties ?? {};
  const place = ["at", "rotation"].map((key): Field => field(key, known[key] ?? {}, true));
  return Object.entries(known)
    .filter(([key]) => !["at", "rotation"].includes(key))
    .map(([key, schema]) => ({ words: key, key, fields: [field("", schema, false), ...place] }));
}

/** How an item holds its kind: around its fields, as the value of `claim`, or beside them. */
export type Style = "wrapped" | "flat" | "beside";

export interface Sort {
  style: Style;
  kinds: Kind[];
}

export function sortOf(model: Model, section: string): Sort {
  if (section === "claims") return { style: "flat", kinds: claims(model) };
  if (section === "shapes") return { style: "beside", kinds: shapes(model) };
  return { style: "wrapped", kinds: wrapped(model, section === "loads" ? "load" : "constraint") };
}
