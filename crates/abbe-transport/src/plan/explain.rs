//! The text of `abbe explain`.

use super::budget::{Budget, PHOTON_DOUBLINGS, PHOTON_HALVINGS};
use super::decide::{EffectRow, EffectState};
use super::fields::{Plan, WavelengthPlan};
use abbe_optics::glass::is_negligible;
use abbe_scene::Scene;
use abbe_scene::camera::{ApertureDiffraction, Camera, DepthOfField, Shutter};

/// Returns the name of the wavelength plan: `free`, `shared` or `both`.
pub fn wavelengths_word(plan: &Plan) -> &'static str {
    match plan.wavelengths {
        WavelengthPlan::Free => "free",
        WavelengthPlan::Shared => "shared",
        WavelengthPlan::Both => "both",
    }
}

/// What the text contains besides the effects that are on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Details {
    /// Describes the effects that are off. Otherwise, one line lists them.
    pub all_effects: bool,
    /// Contains notes about the index of glass where it changes no colour.
    pub negligible_notes: bool,
}

impl Details {
    /// Everything.
    pub const ALL: Self = Self { all_effects: true, negligible_notes: true };
}

/// Returns the plan as text: two lines per effect (the state with its reason, and the consequence),
/// then the wavelengths, the film, the camera, the budget and the notes.
pub fn text(scene: &Scene, plan: &Plan, rows: &[EffectRow], budget: &Budget, details: Details) -> String {
    let mut lines = vec![format!("{}", scene.title), String::new(), "Effects:".to_string()];
    for row in rows.iter().filter(|row| row.state.is_on() || details.all_effects) {
        lines.push(format!("  {:<15} {:<9} {}", row.effect.name, row.state.word(), row.because));
        let consequence = if row.state.is_on() { row.effect.cost } else { row.effect.absent };
        lines.push(format!("  {:<15} {:<9} → {consequence}", "", ""));
    }
    if !details.all_effects {
        lines.extend(effects_that_are_off(rows));
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
    let photons = match budget.photons {
        photons if budget.photons_are_explicit => photons.to_string(),
        photons => format!("{} to {}", photons >> PHOTON_HALVINGS, photons << PHOTON_DOUBLINGS),
    };
    let samples = match budget.camera_samples {
        Some(1) => "1 camera sample per pixel".to_owned(),
        Some(count) => format!("{count} camera samples per pixel"),
        None => "a number of camera samples per pixel that a pilot chooses".to_owned(),
    };
    lines.push(format!("Passes: {}, each with {photons} photon paths and {samples}", budget.passes));
    lines.extend(motion_text(scene, budget));
    lines.push(match budget.radius_m {
        Some(radius) => format!("First kernel radius: {radius} m, set by the scene"),
        None => format!("First kernel radius: set per pixel by a pilot, to contain {} photons", budget.nearest),
    });
    lines.push(format!("Memory: about {:.0} MB", budget.memory_bytes as f64 / 1e6));
    let notes = scene.notes.iter().filter(|note| details.negligible_notes || !is_negligible(note));
    lines.extend(notes.map(|note| format!("Note: {note}")));
    lines.join("\n") + "\n"
}

/// Returns a line with the names of the effects that are off.
fn effects_that_are_off(rows: &[EffectRow]) -> Option<String> {
    let off = rows.iter().filter(|row| !row.state.is_on());
    let (absent, others): (Vec<&EffectRow>, Vec<&EffectRow>) =
        off.partition(|row| row.state == EffectState::Off && row.because == row.effect.not_required);
    let names = |rows: Vec<&EffectRow>| rows.iter().map(|row| row.effect.name).collect::<Vec<_>>().join(", ");
    let parts = [("because the scene has nothing that needs them", absent), ("forbidden or negligible", others)];
    let parts = parts.into_iter().filter(|(_, rows)| !rows.is_empty());
    let parts: Vec<String> = parts.map(|(why, rows)| format!("{why}: {}", names(rows))).collect();
    (!parts.is_empty()).then(|| format!("  off, {}", parts.join("; ")))
}

/// Tells how far objects move over the picture, and whether they may appear as separate images.
fn motion_text(scene: &Scene, budget: &Budget) -> Option<String> {
    let Shutter { open_s, close_s, .. } = scene.shutter;
    scene.moves().then(|| {
        let verdict = if budget.strobes() {
            "fewer than two passes per pixel, so separate images may be visible"
        } else {
            "at least two passes per pixel"
        };
        format!("Motion: up to {:.1} pixels from {open_s} s to {close_s} s; {verdict}", budget.motion_px)
    })
}

/// Describes the field of view, the depth of field and the diffraction of the camera.
fn camera_text(camera: &Camera) -> String {
    if let Some([width, height]) = camera.orthographic_size_m() {
        return format!("Camera: {width:.4} m × {height:.4} m, orthographic: all distances are sharp");
    }
    let [across, down] = camera.field_of_view().map(f64::to_degrees);
    let view = format!("Camera: {across:.1}° × {down:.1}°");
    let Some(depth) = DepthOfField::of(camera) else {
        return format!("{view}, a pinhole: all distances are sharp");
    };
    let DepthOfField { focus_m, near_m, far_m, hyperfocal_m, blur_at_infinity_px } = depth;
    let airy = ApertureDiffraction::of(camera).map_or(0.0, |diffraction| diffraction.airy_diameter_px());
    let far = if far_m.is_finite() { format!("{far_m:.4} m") } else { "infinity".to_owned() };
    format!(
        "{view}, focused at {focus_m:.4} m: blur below a pixel from {near_m:.4} m to {far}; a point at infinity spreads over \
         {blur_at_infinity_px:.1} pixels; hyperfocal distance {hyperfocal_m:.4} m; Airy disk of green light {airy:.2} pixels wide, {}",
        if camera.diffracts { "simulated" } else { "not simulated" }
    )
}
