import { expect, test } from 'vitest';
import { pictureSvg, SvgContext } from './svgContext';

const metrics = (font: string, text: string) => ({ width: text.length * Number.parseFloat(font.split(' ')[1]!) * 0.5 }) as TextMetrics;

test('texts with outlines, lines and dots are vectors', () => {
  const context = new SvgContext(metrics);
  context.font = '600 12px system-ui, sans-serif';
  context.textBaseline = 'middle';
  context.strokeStyle = '#fff';
  context.lineWidth = 4;
  context.fillStyle = '#123456';
  context.strokeText('a < b & "c"', 10, 20);
  context.fillText('a < b & "c"', 10, 20);
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(1, 2);
  context.lineTo(3.14159, 4);
  context.stroke();
  context.beginPath();
  context.arc(5, 6, 2);
  context.fill();
  const lines = context.elements.split('\n');
  expect(lines).toHaveLength(3);
  expect(lines[0]).toContain('>a &lt; b &amp; &quot;c&quot;</text>');
  expect(lines[0]).toContain('paint-order="stroke"');
  expect(lines[0]).toContain('y="24.2"');
  expect(lines[1]).toContain('d="M1 2L3.14 4"');
  expect(lines[2]).toContain('<circle cx="5" cy="6" r="2" fill="#123456"/>');
  expect(context.measureText('abcd').width).toBe(24);
});

test('an outline belongs to its own text only', () => {
  const context = new SvgContext(metrics);
  context.strokeText('one', 0, 0);
  context.fillText('two', 0, 0);
  expect(context.elements).not.toContain('paint-order');
});

test('a picture has its size on paper', () => {
  const svg = pictureSvg({ width: 2008, height: 1004, dpi: 600, scale: 4.6875 }, 'data:image/png;base64,AA==', '<path d="M0 0"/>');
  expect(svg).toContain('width="85.01mm" height="42.5mm" viewBox="0 0 428.37 214.19"');
  expect(svg.indexOf('<image')).toBeLessThan(svg.indexOf('<path'));
});
