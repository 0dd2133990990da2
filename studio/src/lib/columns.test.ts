import { expect, test } from 'vitest';
import { column } from './columns';

test('columns are identified by their names', () => {
  const cases: [string, string, string][] = [
    ['q2_m', 'rods', 'q₂'],
    ['L31_m', 'sides', 'L₃₁'],
    ['l1_m', 'virtual_linear', 'l₁'],
    ['dr3_m', 'virtual_linear', 'dr₃'],
    ['phi2_rad', 'virtual_angular', 'φ₂'],
    ['dphi1_rad', 'virtual_angular', 'dφ₁'],
    ['origin_y_m', 'center_shift', 'y'],
    ['origin_z_m', 'other', 'origin_z_m'],
    ['torsion_rad', 'torsion', 'τ'],
    ['axis_height_m', 'other', 'axis_height_m'],
    ['status', 'other', 'status'],
  ];
  for (const [name, quantity, symbol] of cases) expect(column(name, 3)).toMatchObject({ name, quantity, symbol });
  expect(column('q1_m', 3).values).toHaveLength(3);
});
