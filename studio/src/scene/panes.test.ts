import { expect, test } from 'vitest';
import { arrangementOf, pictureArrangement, split } from './panes';

test('narrow views have one pane above the other', () => {
  expect([arrangementOf(599), arrangementOf(600)]).toEqual(['column', 'row']);
  expect(split({ width: 800, height: 500 }, 'row')).toEqual([{ left: 0, top: 0, right: 400, bottom: 500 }, { left: 400, top: 0, right: 800, bottom: 500 }]);
  expect(split({ width: 390, height: 500 }, 'column')).toEqual([{ left: 0, top: 0, right: 390, bottom: 250 }, { left: 0, top: 250, right: 390, bottom: 500 }]);
});

test('the panes of a picture have about the shape of those of the view', () => {
  const [wide, narrow] = [{ width: 750, height: 850 }, { width: 390, height: 540 }];
  // A picture with the shape of the view is arranged like it, whatever its size.
  for (const view of [wide, narrow]) for (const scale of [0.2, 1, 5]) expect(pictureArrangement({ width: scale * view.width, height: scale * view.height }, view)).toBe(arrangementOf(view.width));
  expect(pictureArrangement({ width: 1280, height: 720 }, wide)).toBe('row');
  expect(pictureArrangement({ width: 1280, height: 720 }, narrow)).toBe('row');
  expect(pictureArrangement({ width: 400, height: 1600 }, wide)).toBe('column');
});
