//! Taught frames of stations: nonlinear least squares of scipy finds the same.
//!
//! Provenance and the reasons for the tolerances: `validation/golden/README.md`.

use jointplay::cell::station::teach::{ReferencePoint, fit_plane, fit_references};
use jointplay::nalgebra::{Rotation2, Vector2, Vector3};
use jointplay::spatial::Pose;
use jointplay_validation::{Row, golden};

/// Of lengths (m); the other program stops at about the root of round-off.
const OF_POSITION: f64 = 1e-10;
/// Of components of normals, whose points are some 0.1 m apart.
const OF_NORMAL: f64 = 1e-9;
/// Of deviations, chi-square and leverages, relative.
const OF_DEVIATION: f64 = 1e-5;

#[track_caller]
fn near(case: usize, column: &str, found: f64, expected: f64, tolerance: f64) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "case {case}: {column} {found} is off by {off:e}");
}

#[test]
fn taught_frames_agree_with_nonlinear_least_squares() {
    let (points, fits) = (golden("teach-points.csv"), golden("teach-fits.csv"));
    assert_eq!(fits.len(), 6);
    for (case, fit) in fits.iter().enumerate() {
        let rows = |kind: &str| -> Vec<&Row> {
            let of_case = points.iter().filter(|row| row.number("case").unwrap() == case as f64);
            of_case.filter(|row| row.text("kind") == kind).collect()
        };
        let expected = |column: &str| fit.number(column).unwrap();
        let relative = |column: &str, found: f64| {
            let expected = expected(column);
            near(case, column, found, expected, OF_DEVIATION * expected.abs().max(1e-3 * found));
        };
        let number = |row: &&Row, column: &str| row.number(column).unwrap();
        let place = |row: &&Row| Vector3::from(["x", "y", "z"].map(|axis| number(row, axis)));
        let noise = |rows: &[&Row]| rows.iter().map(|row| number(row, "noise")).collect::<Vec<_>>();

        let measured = rows("plane");
        let plane = measured.iter().map(place).collect::<Vec<_>>();
        let plane = fit_plane(&plane, 1e-3, Some(&noise(&measured))).unwrap();
        for (axis, column) in ["normal_x", "normal_y", "normal_z"].into_iter().enumerate() {
            near(case, column, plane.normal[axis], expected(column), OF_NORMAL);
        }
        let origin = plane.frame(&Vector3::new(0.7, 0.0, 0.0), 0.0).translation.vector;
        near(case, "height_at_700_0", origin.z, expected("height_at_700_0"), OF_POSITION);
        let known = plane.uncertainty.as_ref().unwrap();
        relative("height_deviation", known.height_deviation(&origin));
        relative("chi_square", plane.agreement.chi_square.unwrap());
        relative("leverage_1", plane.agreement.diagnostics[0].leverage);
        relative("leverage_2", plane.agreement.diagnostics[1].leverage);

        let measured = rows("reference");
        let reference = |row: &&Row| ReferencePoint {
            nominal: Vector2::new(number(row, "across"), number(row, "inward")),
            measured: place(row),
        };
        let references: Vec<ReferencePoint> = measured.iter().map(reference).collect();
        let noise = noise(&measured);
        let found = fit_references(&Pose::identity(), &references, 1e-3, Some(&noise)).unwrap();
        near(case, "shift_x", found.shift.x, expected("shift_x"), OF_POSITION);
        near(case, "shift_y", found.shift.y, expected("shift_y"), OF_POSITION);
        near(case, "turn", found.turn.unwrap(), expected("turn"), 10.0 * OF_POSITION);
        let known = found.uncertainty.unwrap();
        // The other program has the axes of the nominal heading.
        let center = Rotation2::new(found.turn.unwrap()) * known.nominal_center;
        let [x, y] = [center.x, center.y];
        relative("shift_x_deviation", known.center.hypot(known.turn * y));
        relative("shift_y_deviation", known.center.hypot(known.turn * x));
        relative("turn_deviation", known.turn);
        relative("reference_chi_square", found.agreement.chi_square.unwrap());
    }
}
