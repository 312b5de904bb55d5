//! The plan in words.

use super::{Budget, Plan, Row, WavelengthPlan};
use crate::scene::Scene;
use crate::scene::camera::{Camera, DepthOfField, Diffraction, Shutter};

/// `free`, `shared` or `both`.
pub fn wavelengths_word(plan: &Plan) -> &'static str {
    match plan.wavelengths {
        WavelengthPlan::Free => "free",
        WavelengthPlan::Shared => "shared",
        WavelengthPlan::Both => "both",
    }
}

/// The whole plan as text, a line for each effect with its reason.
pub fn text(scene: &Scene, plan: &Plan, rows: &[Row], budget: &Budget) -> String {
    let mut lines = vec![format!("{}", scene.title), String::new(), "Effects:".to_string()];
    for row in rows {
        lines.push(format!("  {:<15} {:<9} {}", row.effect.name, row.state.word(), row.because));
        let consequence = if row.state.is_on() { row.effect.cost } else { row.effect.absent };
        lines.push(format!("  {:<15} {:<9} → {consequence}", "", ""));
    }
    let film = &scene.film;
    lines.push(String::new());
    lines.push(format!("Wavelengths: {}", wavelengths_word(plan)));
    lines.push(format!(
        "Film: {} × {}, {} primitives, {} lights",
        film.width,
        film.height,
        scene.geometry.primitive_count(),
        scene.lights.len()
    ));
    lines.push(camera_text(&scene.camera));
    lines.push(format!("Passes: {}, each of {} photon paths", budget.passes, budget.photons));
    lines.extend(motion_text(scene, budget));
    lines.push(match budget.radius_m {
        Some(radius) => format!("First radius: {radius} m, as the scene says"),
        None => format!("First radius: per pixel, around the {} nearest photons of a pilot", budget.nearest),
    });
    lines.push(format!("Memory: about {:.0} MB", budget.memory_bytes as f64 / 1e6));
    lines.extend(scene.notes.iter().map(|note| format!("Note: {note}")));
    lines.join("\n") + "\n"
}

/// How far things move over the picture, and what that asks of the passes.
fn motion_text(scene: &Scene, budget: &Budget) -> Option<String> {
    let Shutter { open_s, close_s, .. } = scene.shutter;
    scene.moves().then(|| {
        let verdict = if budget.strobes() {
            "fewer than two passes a pixel: steps may be seen"
        } else {
            "at least two passes a pixel"
        };
        format!("Motion: up to {:.1} pixels from {open_s} s to {close_s} s; {verdict}", budget.motion_px)
    })
}

/// The field of view, and what an open lens keeps sharp.
fn camera_text(camera: &Camera) -> String {
    let [across, down] = camera.field_of_view().map(f64::to_degrees);
    let view = format!("Camera: {across:.1}° × {down:.1}°");
    let Some(depth) = DepthOfField::of(camera) else {
        return format!("{view}, a pinhole: everything is sharp");
    };
    let DepthOfField { focus_m, near_m, far_m, hyperfocal_m, blur_at_infinity_px } = depth;
    let airy = Diffraction::of(camera).map_or(0.0, |diffraction| diffraction.airy_diameter_px());
    let far = if far_m.is_finite() { format!("{far_m:.4} m") } else { "infinity".to_owned() };
    format!(
        "{view}, focused at {focus_m:.4} m: blur below a pixel from {near_m:.4} m to {far}; a point at infinity spreads over \
         {blur_at_infinity_px:.1} pixels; hyperfocal distance {hyperfocal_m:.4} m; Airy disk of green light {airy:.2} pixels wide, {}",
        if camera.diffracts { "simulated" } else { "not simulated" }
    )
}
