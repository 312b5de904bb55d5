//! Reads a Zemax file, and prints the focal length, the back focus and the spots of the system.
//!
//! ```text
//! cargo run --release -p abbe-optics --example zemax_lens -- LENS.zmx
//! ```
//!
//! Without an argument, the example reads `cooke_triplet.zmx` beside its source.

use abbe_optics::lens::zemax::{ZmxSystem, parse_system};
use abbe_optics::lens::{AnalysisConditions, LensAnalysis};
use abbe_spectra::{Error, Result};
use std::path::PathBuf;

fn main() -> Result<()> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/cooke_triplet.zmx");
    let path = std::env::args_os().nth(1).map_or_else(|| PathBuf::from(default), PathBuf::from);
    let bytes = std::fs::read(&path).map_err(|error| Error::input(error.to_string()).in_file(&path))?;
    match parse_system(&bytes, &path, &[])? {
        ZmxSystem::Lens(lens) => {
            let analysis = LensAnalysis::of(&lens, None)?;
            println!("{}: {} surfaces, {:.2} mm long", lens.name(), lens.surfaces().len(), lens.length_mm());
            for line in &analysis.lines {
                println!("line {}: f = {:.3} mm, back focus {:.3} mm", line.line, line.efl_mm, line.bfd_mm);
            }
            println!("longitudinal colour F − C: {:.3} mm", analysis.fc_shift_mm());
            for field in &analysis.fields {
                let spots = analysis.lines.iter().zip(&field.spots);
                let spots: Vec<String> =
                    spots.map(|(line, spot)| format!("{} {:.1}", line.line, 1000.0 * spot.rms_mm)).collect();
                let (angle, height) = (field.angle_deg, field.image_height_mm);
                println!("{angle:5.1}°: image at {height:7.3} mm, RMS spots {} µm", spots.join(", "));
            }
            lens.notes().iter().for_each(|note| println!("note: {note}"));
        }
        ZmxSystem::Folded(system) => {
            let analysis = system.analysis(AnalysisConditions::default())?;
            let mm = |value: Option<f64>| value.map_or("none".to_string(), |mm| format!("{mm:.3} mm"));
            println!("{}: {} mirrors", system.name, system.mirrors());
            println!("f = {} along y and {} along x", mm(analysis.efl_mm[0]), mm(analysis.efl_mm[1]));
            println!("back focus {} along y", mm(analysis.back_focus_mm[0]));
        }
    }
    Ok(())
}
