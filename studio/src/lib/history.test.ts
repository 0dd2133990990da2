import { expect, test } from 'vitest';
import { History } from './history';

test('undo and redo restore states', () => {
  const history = new History({ at: 0 });
  expect(history.undo()).toBeUndefined();
  history.commit({ at: 1 });
  history.commit({ at: 2 });
  expect(history.undo()).toEqual({ at: 1 });
  expect(history.undo()).toEqual({ at: 0 });
  expect(history.canUndo).toBe(false);
  expect(history.redo()).toEqual({ at: 1 });
  expect(history.present).toEqual({ at: 1 });
});

test('a new step discards undone steps', () => {
  const history = new History(0);
  history.commit(1);
  history.undo();
  history.commit(2);
  expect(history.canRedo).toBe(false);
  expect(history.undo()).toBe(0);
});

test('a step without a change is not added', () => {
  const history = new History({ at: [1, 2] });
  expect(history.commit({ at: [1, 2] })).toBe(false);
  expect(history.canUndo).toBe(false);
});

test('the oldest steps are discarded', () => {
  const history = new History(0, 2);
  for (const value of [1, 2, 3]) history.commit(value);
  expect(history.undo()).toBe(2);
  expect(history.undo()).toBe(1);
  expect(history.undo()).toBeUndefined();
});
