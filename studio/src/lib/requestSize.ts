// Size of requests, compared with the limit of the server.

/** Largest body of a request that the server accepts [bytes]; a test of the server reads it here and compares them. */
export const MAX_BODY_BYTES = 10_000_000;
/** Share of texts in a body; the rest is left for parameters and coordinates. */
const SHARE_OF_TEXTS = 0.9;

/** Size of a value as JSON in a request [bytes]; escaped characters need more than in a file. */
export const jsonBytes = (value: unknown): number => new TextEncoder().encode(JSON.stringify(value)).length;

/** Reason why texts cannot be sent in a request; `null` if they can. */
export function sizeProblem(name: string, texts: unknown): string | null {
  const bytes = jsonBytes(texts);
  const allowed = SHARE_OF_TEXTS * MAX_BODY_BYTES;
  const megabytes = (value: number) => `${(value / 1e6).toFixed(2)} MB`;
  return bytes > allowed ? `${name} is too large: it needs ${megabytes(bytes)} in a request, and ${megabytes(allowed)} are allowed.` : null;
}

/** Reason why a file is not read: its text is longer than any request. A text as JSON is never shorter than its file. */
export function fileSizeProblem({ name, size }: { name: string; size: number }): string | null {
  return size > MAX_BODY_BYTES ? `${name} is too large: it has ${(size / 1e6).toFixed(2)} MB, and ${(SHARE_OF_TEXTS * MAX_BODY_BYTES / 1e6).toFixed(2)} MB are allowed in a request.` : null;
}
