import { expect, test } from 'vitest';
import { figureSvg, ticks } from './plotsvg';

test('ticks are round numbers within the range', () => {
  const cases: [number, number, number, number[]][] = [
    [0, 10, 5, [0, 2, 4, 6, 8, 10]],
    [-0.25, 0.25, 5, [-0.2, -0.1, 0, 0.1, 0.2]],
    [93.218, 93.2464, 3, [93.22, 93.23, 93.24]],
    [1, 1, 4, [1]],
  ];
  for (const [low, high, about, expected] of cases) {
    const found = ticks(low, high, about);
    expect(found).toHaveLength(expected.length);
    found.forEach((value, i) => expect(value).toBeCloseTo(expected[i]!, 9));
  }
});

test('a figure has titles, and its points are at their coordinates', () => {
  const drawing = {
    title: 'Rods <q>',
    x: { title: 'sample', range: [0, 10] as [number, number] },
    y: { title: 'mm', range: [0, 1] as [number, number] },
    series: [{ name: 'q₁', colour: '#0072b2', dash: [8, 4], points: [[0, 0], [10, 1]] as [number, number][] }],
  };
  const svg = figureSvg([drawing, { ...drawing, title: 'Sides' }]);
  expect(svg).toContain('Rods &lt;q>');
  expect(svg).toContain('Sides');
  expect(svg.match(/d="M84 312L704 34"/g)).toHaveLength(2);
  expect(svg).toContain('stroke-dasharray="8 4"');
  expect(svg).toContain('height="720"');
  expect(svg).toContain('translate(0 360)');
});
