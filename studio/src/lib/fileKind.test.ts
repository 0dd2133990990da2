import { expect, test } from 'vitest';
import { kindOfFile } from './fileKind';

test('the extension decides for programs whose text declares no kind', () => {
  const cases: [string, string, ReturnType<typeof kindOfFile>][] = [
    ['b.program', 'unknown', 'program'], ['B.PROGRAM', 'unknown', 'program'], ['b.program', 'program', 'program'], ['b.txt', 'program', 'program'],
    ['b.txt', 'unknown', null], ['program', 'unknown', null], ['b.program', 'cell', 'cell'], ['r.toml', 'three_rods', 'three_rods'], ['s.toml', 'study', null],
  ];
  for (const [name, declared, kind] of cases) expect(kindOfFile(name, declared), `${name}, ${declared}`).toBe(kind);
});
