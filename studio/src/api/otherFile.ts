// A server that was restarted may have another file than the page: nothing is saved into it.

/** Why a text is not saved, if the server has another file than that of the text; `null` where it has the same, or none that can be read. */
export async function otherFile(name: string, read: () => Promise<{ name: string; isSame?: boolean }>): Promise<string | null> {
  try {
    const found = await read();
    if (found.isSame ?? found.name === name) return null;
    return `Not saved: the server has the file ${found.name} now, and not ${name}. Download the text, or start the studio with ${name}.`;
  } catch {
    // Saving reports it.
    return null;
  }
}
