//! The text of `abbe lens` for a system with mirrors or coordinate breaks.

use crate::reports::folded_lens::{FoldedFieldReport, FoldedLensReport};

pub(super) fn text(report: &FoldedLensReport<'_>) -> String {
    let FoldedLensReport { name, surfaces, mirrors, .. } = report;
    let mut text = format!("{name} ({surfaces} surfaces, {mirrors} of them mirrors)\n");
    let pair = |along_y: f64, along_x: f64| {
        if (along_y - along_x).abs() <= 1e-5 * along_y.abs() {
            format!("{along_y:.4} mm")
        } else {
            format!("{along_y:.4} mm along y, {along_x:.4} mm along x")
        }
    };
    for (label, value) in [
        ("focal length", pair(report.efl_mm, report.efl_x_mm)),
        ("back focus", pair(report.bfd_mm, report.bfd_x_mm) + " from the last surface"),
        ("image plane", format!("{:.4} mm from the last surface, as in the file", report.image_distance_mm)),
        ("f-number", format!("{:.4}", report.f_number)),
        ("entrance", format!("{:.4} mm wide", report.entrance_diameter_mm)),
    ] {
        text += &format!("{label:<15} {value}\n");
    }
    text += "\nfield       image x     image y   spot radius (RMS) in F, d, C     passing\n";
    for field in &report.fields {
        let spots = field.spots.iter().map(|spot| format!("{:>9.2}", 1e3 * spot.rms_mm)).collect::<String>();
        let FoldedFieldReport { angle_deg, image_x_mm, image_height_mm, passing, .. } = field;
        let angle = format!("{angle_deg:.2}°");
        // Rounded before it is printed, so that no zero has a sign.
        let rounded = |mm: f64| (1e3 * mm).round() / 1e3 + 0.0;
        let (image_x_mm, image_height_mm) = (rounded(*image_x_mm), rounded(*image_height_mm));
        text += &format!(
            "{angle:<7} {image_x_mm:>8.3} mm {image_height_mm:>8.3} mm {spots} µm {:>7.1} %\n",
            100.0 * passing
        );
    }
    text
}
