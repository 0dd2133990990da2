// Texts of files that were chosen or dropped.

/** The text of a file; an error for files of other kinds, whose bytes would be replaced. */
export async function textOf(file: File): Promise<string> {
  let text: string | null = null;
  try {
    text = new TextDecoder('utf-8', { fatal: true }).decode(await file.arrayBuffer());
  } catch (error) {
    if (!(error instanceof TypeError)) throw error;
  }
  if (text === null || text.includes('\0')) throw new Error(`${file.name} is not a text file in UTF-8.`);
  return text;
}
