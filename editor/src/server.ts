// Requests to the server, which is where the page came from: addresses are relative, the token is in the page's own.

export class Refused extends Error {
  constructor(
    readonly status: number,
    readonly body: Record<string, unknown>,
  ) {
    super(typeof body["message"] === "string" ? body["message"] : `the server answered ${status}`);
  }
}

/** The server does not answer: stopped, or the machine sleeps. */
export class Away extends Error {}

/** What a failed request is told as. */
export function wordsOf(failure: unknown): string {
  return failure instanceof Error ? failure.message : String(failure);
}

async function answered<Answer>(request: Promise<Response>): Promise<Answer> {
  let response: Response;
  try {
    response = await request;
  } catch (failure) {
    if (failure instanceof DOMException && failure.name === "AbortError") throw failure;
    throw new Away("the server does not answer: is `mbsym edit` still running?");
  }
  const body = (await response.json().catch(() => ({}))) as Record<string, unknown>;
  if (!response.ok) throw new Refused(response.status, body);
  return body as Answer;
}

export function get<Answer>(name: string): Promise<Answer> {
  return answered<Answer>(fetch(`api/${name}`, { cache: "no-store", credentials: "omit" }));
}

export function post<Answer>(name: string, body: object, signal?: AbortSignal): Promise<Answer> {
  return answered<Answer>(
    fetch(`api/${name}`, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(body),
      cache: "no-store",
      credentials: "omit",
      signal: signal ?? null,
    }),
  );
}
