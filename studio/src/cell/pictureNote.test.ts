import { expect, test } from 'vitest';
import { pictureNote, type NotedState } from './pictureNote';

const state: NotedState = { playback: { time: 83.4 }, loading: false, outdated: false, plan: { violations: 0 }, jog: { active: false, outdated: false, document: null }, tools: { playScale: 1, section: null, hidden: new Set() } };
const jogged = (violations: number, outdated = false) => ({ active: true, outdated, document: { check: { violations: Array(violations).fill({}) } } });

test('a note has the time of the program only while the view shows it', () => {
  expect(pictureNote(state, 'fab', 'mm')).toBe('fab, 1:23.4');
  expect(pictureNote({ ...state, loading: true }, 'fab', 'mm')).toBe('fab, 1:23.4, motion not loaded');
  expect(pictureNote({ ...state, jog: jogged(0) }, 'fab', 'mm')).toBe('fab, jogged');
});

test('a note reports the check of what is shown', () => {
  expect(pictureNote({ ...state, plan: { violations: 2 } }, 'fab', 'mm')).toContain('not safe to run: 2 violations');
  expect(pictureNote({ ...state, plan: { violations: 2 }, outdated: true }, 'fab', 'mm')).toMatch(/outdated check$/);
  // The violations of the program do not belong to a jogged pose.
  expect(pictureNote({ ...state, plan: { violations: 2 }, jog: jogged(1) }, 'fab', 'mm')).toBe('fab, jogged · 1 violation');
  expect(pictureNote({ ...state, jog: jogged(1, true) }, 'fab', 'mm')).toBe('fab, jogged · outdated check');
});

test('a note mentions what is cut and hidden', () => {
  const note = pictureNote({ ...state, tools: { playScale: 250, section: { axis: 'y', at: -0.1204 }, hidden: new Set(['wall']) } }, 'fab', 'mm');
  expect(note).toBe('fab, 1:23.4 · play scale 250× · section at y = −120 mm · 1 part hidden');
  expect(pictureNote({ ...state, tools: { ...state.tools, section: { axis: 'y', at: -0.1204 } } }, 'fab', 'inch')).toContain('section at y = −4.74 in');
});
