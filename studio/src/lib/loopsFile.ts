// Files that close the loops of a model.

/** Whether a text closes the loops of a model that is in a file of its own. */
export const closesLoops = ({ name, text }: { name: string; text: string }): boolean => /\.ya?ml$/i.test(name) || /^\s*kind\s*=\s*["']loops["']/m.test(text);
