import { expect, test } from 'vitest';
import type { StationDocument } from '../api/client';
import { dragged } from './stationDrag';

const STATION = {
  name: 'LP',
  position_mm: [100, 200, 500],
  heading_rad: 0.5,
  about_x_rad: 0.01,
  about_y_rad: 0,
  tilt_angle_deg: 0.57,
  tilt_azimuth_deg: -90,
} as unknown as StationDocument;

test('a drag along an axis changes one coordinate in steps of 0.01 mm', () => {
  const { station, change } = dragged(STATION, 'height', 1.23456, 0.02);
  expect(station.position_mm).toEqual([100, 200, 501.23]);
  expect(change).toEqual({ position_m: [0.1, 0.2, 0.50123] });
});

test('a dragged tilt is limited to that of the robot', () => {
  const { station, change } = dragged(STATION, 'about_y', 5, 0.02);
  expect(Math.hypot(station.about_x_rad, station.about_y_rad)).toBeCloseTo(0.02, 12);
  expect(Object.keys(change)).toEqual(['tilt_xy']);
  expect(station.tilt_angle_deg).toBeCloseTo((0.02 * 180) / Math.PI, 9);
});

test('a dragged heading changes only the heading', () => {
  const { station, change } = dragged(STATION, 'heading', 10, 0.02);
  expect(station.position_mm).toEqual(STATION.position_mm);
  expect(station.heading_rad - STATION.heading_rad).toBeCloseTo((10 * Math.PI) / 180, 4);
  expect(change.heading_rad).toBe(station.heading_rad);
  expect(Object.keys(change)).toEqual(['heading_rad']);
});

test('a tilt preserves the definition of a station by its first and last slot', () => {
  const { change } = dragged({ ...STATION, from: 'carrier axis' }, 'about_x', 0.1, 0.02);
  expect(change.keep_carrier_axis).toBe(true);
  expect(change.tilt_xy?.about_x_rad).toBeCloseTo(0.01 + (0.1 * Math.PI) / 180, 4);
});
