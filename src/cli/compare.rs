//! `abbe compare`: measures the difference between a picture and a reference.

use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::output::compare::{Comparison, Region, Selection, compare};
use crate::output::comparison_page::{PicturePair, page};
use crate::output::exr::read;
use crate::output::file;
use crate::output::png::read_mask;

use super::{Outcome, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct CompareArgs {
    /// The picture
    #[arg(value_name = "A.exr")]
    picture: PathBuf,
    /// The reference
    #[arg(value_name = "B.exr")]
    reference: PathBuf,
    /// Compare only these pixels: columns x0 to x1 and rows y0 to y1, without x1 and y1
    /// (repeatable)
    #[arg(long, value_name = "x0,y0,x1,y1", value_parser = values::region)]
    region: Vec<Region>,
    /// Compare only pixels that are not black in this image
    #[arg(long, value_name = "FILE.png")]
    mask: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write an HTML page with the pictures, their differences, their error maps and all numbers
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Exit with status 3 if the relative mean square error exceeds this value
    #[arg(long, value_name = "RELMSE", value_parser = values::limit)]
    fail_above: Option<f64>,
}

pub(crate) fn run(arguments: &CompareArgs) -> Result<Outcome> {
    let picture = read(&arguments.picture)?.picture;
    let reference = read(&arguments.reference)?.picture;
    let mask = match &arguments.mask {
        Some(path) => Some(read_mask(path, reference.width, reference.height)?),
        None => None,
    };
    let selection = Selection { regions: arguments.region.clone(), mask };
    let comparison = compare(&picture, &reference, &selection)?;
    if let Some(path) = &arguments.html {
        let (a, b) = (name(&arguments.picture), name(&arguments.reference));
        let pair = PicturePair { picture: (&a, &picture), reference: (&b, &reference) };
        file::write_whole(path, page(pair, &selection, &comparison)?.as_bytes())?;
    }
    if arguments.json {
        print::json(&comparison)?
    } else {
        print::result(&text(&comparison))?
    }
    // An error that is not a number exceeds every limit.
    let within = arguments.fail_above.is_none_or(|limit| comparison.relative_mse <= limit);
    Ok(if within { Outcome::Done } else { Outcome::Exceeded })
}

fn name(path: &Path) -> String {
    path.display().to_string()
}

fn text(comparison: &Comparison) -> String {
    let z = comparison.z.map_or("unknown: a picture has no error layers".to_string(), |z| {
        format!("{:.1} % of {} pixels have |z| < 1.96", 100.0 * z.share, z.pixels)
    });
    let covered = comparison.covered.map_or("unknown: A has no error layers".to_string(), |covered| {
        let share = 100.0 * covered.share;
        format!("the 95 % interval of A contains B in {share:.1} % of {} pixels", covered.pixels)
    });
    let mut text = format!(
        "relative MSE   {:.6}   without the worst 2 %: {:.6}\nRMSE of Y      {:.6} cd/m²\nmean Y, A / B  {:.6}\n\
         ΔE2000         {:.3} mean, {:.3} at 95 %\nz-test         {z}\nerror bars     {covered}\npixels         {}\n",
        comparison.relative_mse,
        comparison.relative_mse_trimmed,
        comparison.rmse,
        comparison.mean_ratio,
        comparison.delta_e_2000.mean,
        comparison.delta_e_2000.p95,
        comparison.pixels,
    );
    if comparison.covered.is_some() && comparison.unknown_pixels > 0 {
        text += &format!("unknown        {} pixels of A that no light reached\n", comparison.unknown_pixels);
    }
    if comparison.non_finite_pixels > 0 {
        text += &format!("not finite     {} pixels\n", comparison.non_finite_pixels);
    }
    text
}
