// Checks that the imports among the files of the page form no circle; type imports and re-exports count.
//
// Run by `npm run check`. A circle means that none of its files can be understood alone: move what both need into a file of its own.

import { readdirSync, readFileSync, statSync } from 'node:fs';
import { dirname, join, relative, resolve } from 'node:path';
import ts from 'typescript';

const ROOT = resolve(import.meta.dirname, 'src');
const ENDINGS = ['', '.ts', '.d.ts', '.svelte.ts', '.svelte', '/index.ts'];

/** All source files below a folder, except for generated ones. */
function sources(folder) {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    if (entry.isDirectory()) return sources(path);
    return /\.(ts|svelte)$/.test(entry.name) ? [path] : [];
  });
}

/** The scripts of a file: the whole of a `.ts` file, the `<script>` elements of a `.svelte` file. */
function script(path) {
  const text = readFileSync(path, 'utf8');
  if (!path.endsWith('.svelte')) return text;
  // A module imported in the markup by `import('…')` is included.
  const scripts = [...text.matchAll(/<script\b[^>]*>([\s\S]*?)<\/script>/g)].map((found) => found[1]);
  const lazy = [...text.matchAll(/\bimport\('([^']+)'\)/g)].map((found) => `import '${found[1]}';`);
  return [...scripts, ...lazy].join('\n');
}

/** The source files that a file imports from, by `import`, `export … from` and `import('…')`. */
function imports(path, known) {
  return ts.preProcessFile(script(path), true, true).importedFiles.flatMap(({ fileName }) => {
    if (!fileName.startsWith('.')) return [];
    // An address is asked for by `?url`.
    const base = resolve(dirname(path), fileName.replace(/\?url$/, ''));
    const found = ENDINGS.map((ending) => base + ending).find((candidate) => known.has(candidate));
    if (found) return [found];
    // Files next to the sources, such as the script of the WebAssembly module.
    if (existsAsFile(base) || (relative(ROOT, base).startsWith('..') && ENDINGS.some((ending) => existsAsFile(base + ending)))) return [];
    throw new Error(`${relative(ROOT, path)} imports ${fileName}, which is not a source file`);
  });
}

function existsAsFile(path) {
  return statSync(path, { throwIfNoEntry: false })?.isFile() ?? false;
}

/** The strongly connected components with more than one file, by Tarjan's algorithm. */
function circles(graph) {
  const index = new Map();
  const low = new Map();
  const stack = [];
  const found = [];
  const visit = (node) => {
    index.set(node, index.size);
    low.set(node, index.get(node));
    stack.push(node);
    for (const next of graph.get(node)) {
      if (!index.has(next)) visit(next);
      if (stack.includes(next)) low.set(node, Math.min(low.get(node), low.get(next)));
    }
    if (low.get(node) !== index.get(node)) return;
    const component = stack.splice(stack.indexOf(node));
    if (component.length > 1 || graph.get(node).includes(node)) found.push(component);
  };
  for (const node of graph.keys()) if (!index.has(node)) visit(node);
  return found;
}

const files = sources(ROOT);
const known = new Set(files);
const graph = new Map(files.map((path) => [path, imports(path, known)]));
const found = circles(graph);
for (const component of found) {
  const members = new Set(component);
  console.error(`import circle of ${component.length} files:`);
  for (const path of component) {
    const within = graph.get(path).filter((next) => members.has(next));
    console.error(`  ${relative(ROOT, path)} imports ${within.map((next) => relative(ROOT, next)).join(', ')}`);
  }
}
if (found.length > 0) process.exit(1);
