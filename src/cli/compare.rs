//! `abbe compare`: measures the difference between a picture and a reference.

use std::path::{Path, PathBuf};

use abbe_session::output::compare::{Comparison, compare_at};
use abbe_session::output::comparison_page::{PicturePair, page};
use abbe_session::output::exr::read as read_exr;
use abbe_session::output::file;
use abbe_session::output::gates::Gate;
use abbe_session::output::png::{read as read_png, read_mask};
use abbe_session::output::selection::{Region, Selection};
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::error::{Error, Result};
use abbe_transport::sensor::{Picture, exposure};

use super::{Outcome, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct CompareArgs {
    /// The picture: an EXR file, or a PNG file if the reference is one
    #[arg(value_name = "A")]
    picture: PathBuf,
    /// The reference
    #[arg(value_name = "B")]
    reference: PathBuf,
    /// Compare only these pixels: columns x0 to x1 and rows y0 to y1, without x1 and y1
    /// (repeatable)
    #[arg(long, value_name = "x0,y0,x1,y1", value_parser = values::region)]
    region: Vec<Region>,
    /// Compare only pixels that are not black in this image
    #[arg(long, value_name = "FILE.png")]
    mask: Option<PathBuf>,
    /// Compare the denoised picture of A, with its own error bars, instead of A as it was rendered
    #[arg(long)]
    denoised: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write an HTML page with the pictures, their differences, their error maps and all numbers
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Exit with status 3 if a figure is above a limit, such as relative_mse=1% or
    /// delta_e_2000.p95=2. A number without a name limits relative_mse (repeatable)
    #[arg(long, value_name = "[FIGURE=]LIMIT", value_parser = values::gate_above)]
    fail_above: Vec<Gate>,
    /// Exit with status 3 if a figure is below a limit, such as z.p=0.01 or covered=90% (repeatable)
    #[arg(long, value_name = "FIGURE=LIMIT", value_parser = values::gate_below)]
    fail_below: Vec<Gate>,
}

/// Two pictures of the same kind.
struct Inputs {
    picture: Picture,
    reference: Picture,
    /// The exposure at which the pictures are compared, in 1/(cd/m²).
    exposure: f64,
    tone: ToneCurve,
}

impl Inputs {
    /// Reads EXR files, at the automatic exposure of the reference, or PNG files as they are.
    fn read(picture: &Path, reference: &Path) -> Result<Self> {
        let is_png = |path: &Path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
        match (is_png(picture), is_png(reference)) {
            (true, true) => {
                let (picture, reference) = (read_png(picture)?, read_png(reference)?);
                Ok(Self { picture, reference, exposure: 1.0, tone: ToneCurve::Clip })
            }
            (false, false) => {
                let (picture, reference) = (read_exr(picture)?.picture, read_exr(reference)?.picture);
                let exposure = exposure::automatic(&reference);
                Ok(Self { picture, reference, exposure, tone: ToneCurve::RollOff })
            }
            (true, false) | (false, true) => {
                let error = Error::input("a PNG file cannot be compared with an EXR file");
                Err(error.expected("two files of the same kind; `abbe develop` makes a PNG file from an EXR file"))
            }
        }
    }
}

pub(crate) fn run(arguments: &CompareArgs) -> Result<Outcome> {
    let inputs = [&arguments.picture, &arguments.reference].into_iter().chain(&arguments.mask);
    file::check_keeps_inputs(arguments.html.as_deref(), inputs)?;
    let Inputs { picture, reference, exposure, tone } = Inputs::read(&arguments.picture, &arguments.reference)?;
    let picture = if arguments.denoised {
        let error = || Error::input("contains no denoised picture").in_file(&arguments.picture);
        picture.denoised().ok_or_else(error)?
    } else {
        picture
    };
    let mask = match &arguments.mask {
        Some(path) => Some(read_mask(path, reference.width, reference.height)?),
        None => None,
    };
    let selection = Selection { regions: arguments.region.clone(), mask };
    let comparison = compare_at(&picture, &reference, &selection, exposure)?;
    let gates = arguments.fail_above.iter().chain(&arguments.fail_below);
    let failures = gates.map(|gate| gate.failure(&comparison)).collect::<Result<Vec<_>>>()?;
    if let Some(path) = &arguments.html {
        let (a, b) = (name(&arguments.picture), name(&arguments.reference));
        let pair = PicturePair { picture: (&a, &picture), reference: (&b, &reference), tone };
        file::write_whole(path, page(pair, &selection, &comparison)?.as_bytes())?;
    }
    if arguments.json {
        print::json(&comparison)?
    } else {
        print::result(&text(&comparison))?
    }
    let failures: Vec<String> = failures.into_iter().flatten().collect();
    failures.iter().for_each(|failure| print::remark(&format!("failed: {failure}")));
    Ok(if failures.is_empty() { Outcome::Done } else { Outcome::Exceeded })
}

fn name(path: &Path) -> String {
    path.display().to_string()
}

fn text(comparison: &Comparison) -> String {
    let z = comparison.z.map_or("unknown: a picture has no error layers".to_string(), |z| {
        format!(
            "{:.1} % of {} pixels have |z| < 1.96; p = {:.3} for the largest difference",
            100.0 * z.fraction,
            z.pixels,
            z.p
        )
    });
    let covered = comparison.covered.map_or("unknown: A has no error layers".to_string(), |covered| {
        let fraction = 100.0 * covered.fraction;
        format!("the 95 % interval of A contains B in {fraction:.1} % of {} pixels", covered.pixels)
    });
    let typical = [comparison.typical_error, comparison.typical_difference].map(print::percent);
    let of_b = if comparison.typical_error < comparison.typical_difference {
        format!("; with the error of B {}", typical[1])
    } else {
        String::new()
    };
    let mut text = format!("typical error  {} of a pixel of A{of_b}\n", typical[0]);
    text += &format!(
        "relative MSE   {:.6}   without the worst 2 %: {:.6}\nRMSE of Y      {:.6} cd/m²\nmean Y, A / B  {:.6}\n\
         ΔE2000         {:.3} mean, {:.3} at 95 % (at EV {:.2})\nz-test         {z}\nerror bars     {covered}\npixels         {}\n",
        comparison.relative_mse,
        comparison.relative_mse_trimmed,
        comparison.rmse,
        comparison.mean_ratio,
        comparison.delta_e_2000.mean,
        comparison.delta_e_2000.p95,
        comparison.exposure_ev,
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
