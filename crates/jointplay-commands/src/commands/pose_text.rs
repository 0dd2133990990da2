//! A pose as text, for `forward` and `inverse`.

use std::fmt::Write as _;

use jointplay::report::ForwardReport;
use jointplay::virtualization::Solver;

use crate::output::{ball_clearance, characteristic_length, limits, three};
use jointplay::format::number::fixed;

/// A pose as text.
///
/// # Arguments
/// * `asked` – the requested solver; the report names another one if there is no closed form
pub(super) fn pose(report: &ForwardReport, asked: Solver) -> String {
    let platform = &report.platform;
    let shift_um = platform.center_shift_mm.map(|shift| shift * 1e3);
    let mut text = String::new();
    let _ = writeln!(text, "rods and sides                      1             2             3");
    let _ = writeln!(text, "  rods q (mm)          {}", three(&report.q_mm, 6));
    let _ = writeln!(text, "  sides 12, 23, 31 (mm){}", three(&report.sides_mm, 6));
    let _ = writeln!(text, "platform                            x             y             z");
    let _ = writeln!(text, "  origin (mm)          {}", three(&platform.origin_mm, 6));
    let _ = writeln!(text, "  normal               {}", three(&platform.normal, 9));
    let _ = writeln!(text, "  centre shift (µm)    {}", three(&shift_um, 3));
    let _ = writeln!(
        text,
        "  tilt                 {}° at azimuth {}°, torsion {}°",
        fixed(platform.tilt_deg, 6),
        fixed(platform.azimuth_deg, 6),
        fixed(platform.torsion_deg, 9)
    );
    let _ = writeln!(
        text,
        "  height (mm)          {} on the base axis, {} at the centre",
        fixed(platform.axis_height_mm, 6),
        fixed(platform.center_height_mm, 6)
    );
    let _ = writeln!(text, "virtual joints, {}", report.virtualization);
    for (name, values) in &report.virtual_joints.0 {
        let (symbol, unit) = name.rsplit_once('_').unwrap_or((name, ""));
        let decimals = if unit == "deg" { 9 } else { 6 };
        let _ = writeln!(text, "  {:<21}{}", format!("{symbol} ({unit})"), three(values, decimals));
    }
    let asked_for = if asked.to_string() == report.solver {
        String::new()
    } else {
        format!(" (no {asked} solution exists for these joints and this geometry)")
    };
    let _ = writeln!(
        text,
        "  solver               {}{asked_for}, {} iterations{}",
        report.solver,
        report.iterations,
        characteristic_length(&report.virtual_joints, report.characteristic_length_mm)
    );
    let _ = writeln!(text, "  side residual        {:.1e} mm", report.residual_mm);
    text + &ball_clearance(&report.ball_clearance) + &limits(&report.limits_broken)
}
